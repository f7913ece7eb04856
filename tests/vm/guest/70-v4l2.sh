# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Cameras of the kernel through v4l2://, opened by the sandboxed service: the Kinect by gspca_kinect, and vivid, the kernel's own
# test camera. There is no map of what they show; frames arrive, and the daemon says that it is lost.
wants_source v4l2
# frames_from NODE OPTIONS: the daemon gets some.
frames_from() {
  configure '[source]' "url = \"v4l2://$1?$2\"" "camera = \"/usr/share/camloc/cameras/kinect-v1.toml\"" 'stall_ms = 5000' '[localize]' 'features = 300'
  systemctl restart camlocd
  within 40 has_frames 3
  say "$1: $(counter frames_received) frames"
}
has_frames() { [[ $(counter frames_received) -ge $1 ]]; }
unit_setting WatchdogSec=60

systemctl stop camlocd
if grep -qs 02ae /sys/bus/usb/devices/*/idProduct; then
  within 20 has_video_node kinect
  frames_from "$(video_node kinect)" 'width=640&height=480'
fi
modprobe vivid n_devs=1 node_types=0x1
udevadm settle
within 20 has_video_node vivid
frames_from "$(video_node vivid)" 'width=640&height=480&format=GREY'
systemctl stop camlocd
modprobe -r vivid
