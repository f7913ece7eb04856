# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The whole chain on a real USB stack: the fake Kinect shows a walk, the sandboxed service takes the camera from the kernel's driver
# and publishes poses of it; pulled out, it says so, and plugged in again there are poses again, in the same process.
wants_source kinect
[[ -f $vm/walk.cmap ]] || skip "no map of the walk"
cp "$vm/walk.cmap" "$map"
configure '[source]' 'url = "kinect://?depth=raw"' 'camera = "/usr/share/camloc/cameras/kinect-v1.toml"' 'stall_ms = 5000' '[localize]' 'features = 300'
unit_setting WatchdogSec=60
systemctl restart camlocd
listen
within 60 has_poses 3
systemctl status --no-pager -n 6 camlocd | sed 's/^/# | /' >&3
before=$(main_pid)

host unplug
within 15 status_has '"state":"NO_CAMERA"'
host replug
poses_go_on 3 60
[[ $(main_pid) == "$before" ]] || fail "it took another process"
say "poses again, $(grep '^status ' "$work/heard" | tail -n 1 | grep -o 'recovery[^ ]*' || true)"
