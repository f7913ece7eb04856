# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The fake Kinect is believed by the kernel: gspca_kinect loads by itself and streams from it. The device has the rights that
# 60-camloc.rules gives, and plugging it in starts the service where it is enabled, and only there.
systemctl enable camlocd
systemctl stop camlocd
host replug
within 20 has_video_node kinect
udevadm settle
grep -q gspca_kinect /proc/modules || fail "gspca_kinect is not loaded"
camera=$(grep -ls 02ae /sys/bus/usb/devices/*/idProduct | head -n 1)
bus=$(printf '/dev/bus/usb/%03d/%03d' "$(cat "${camera%/*}/busnum")" "$(cat "${camera%/*}/devnum")")
[[ $(stat -c '%G %a' "$bus") == "plugdev 660" ]] || fail "$bus is $(stat -c '%G %a' "$bus")"
within 20 is_active
say "plugging in started the service"

systemctl stop camlocd
# stream COUNT FILE. A frame that lost packets on its way is shorter than a whole one.
whole=$((640 * 480))
stream() {
  v4l2-ctl -d "$(video_node kinect)" --set-fmt-video=width=640,height=480,pixelformat=GRBG --stream-mmap --stream-count="$1" \
    --stream-to="$2" >"$work/stream" 2>&1
}
stream 15 "$work/frames" || fail "$(tail -n 3 "$work/stream")"
[[ $(stat -c %s "$work/frames") -ge $((8 * whole)) ]] || fail "$(stat -c %s "$work/frames") bytes in 15 frames"
say "15 frames, $(($(stat -c %s "$work/frames") * 100 / (15 * whole))) % of their bytes, $(grep -o '[0-9.]* fps' "$work/stream" | tail -n 1)"
has_whole_frame() { stream 1 "$work/frame" && [[ $(stat -c %s "$work/frame") -eq $whole ]]; }
within 30 has_whole_frame
host served video "$(md5sum <"$work/frame" | cut -c1-32)"

systemctl disable camlocd
host unplug
host replug
within 20 has_video_node kinect
sleep 2
! is_active || fail "a disabled service was started by the camera"
systemctl enable camlocd
