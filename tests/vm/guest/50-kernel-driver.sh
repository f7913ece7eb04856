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
v4l2-ctl -d "$(video_node kinect)" --set-fmt-video=width=640,height=480,pixelformat=GRBG \
  --stream-mmap --stream-count=15 --stream-to="$work/frames" >"$work/stream" 2>&1 || fail "$(tail -n 3 "$work/stream")"
size=$(stat -c %s "$work/frames")
[[ $size -eq $((15 * 640 * 480)) ]] || fail "$size bytes in 15 frames"
host served video "$(tail -c $((640 * 480)) "$work/frames" | md5sum | cut -c1-32)"
say "15 frames, $(grep -o '[0-9.]* fps' "$work/stream" | tail -n 1)"

systemctl disable camlocd
host unplug
host replug
within 20 has_video_node kinect
sleep 2
! is_active || fail "a disabled service was started by the camera"
systemctl enable camlocd
