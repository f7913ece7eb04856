# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# What the scenarios share. A scenario is a file NN-name.sh that ends with success, fails by `fail` or at a command that fails, or
# leaves with `skip`.

vm=/root/vm
config=/etc/camloc/camlocd.toml.d/test.toml
map=/var/lib/camloc/building.cmap

say() { echo "# $*" >&3; }
fail() { say "failed: $*"; exit 1; }
skip() { echo "$*" >"$work/skipped"; exit 0; }

# Emulated processors are some thirty times slower than the host's; on a busy host, more. Times below are for an idle one.
patience=$(cat "$vm/patience")

# within SECONDS COMMAND...: until it succeeds, or fails after that time.
within() {
  local limit=$((SECONDS + $1 * patience))
  shift
  until "$@"; do
    if [[ $SECONDS -ge $limit ]]; then fail "not in time: $*"; fi
    sleep 0.2
  done
}

# host REQUEST: something that only the outside can do, e.g. pull the plug. Returns when it is done.
host() {
  local answer
  echo "@$*" >&3
  read -r -t $((30 * patience)) answer <&4 || fail "the host does not answer to $*"
  [[ $answer == "done" ]] || fail "the host says to $*: $answer"
}

# What the daemon says about itself.
status() { camloc ctl --json status; }
status_has() { status 2>/dev/null | tr -d ' \n' | grep -q -- "$1"; }
counter() { status | tr -d ' \n' | sed -n "s/.*\"$1\":\([0-9]*\).*/\1/p"; }

# listen: collects what arrives over LCM in $work/heard until the scenario is over.
listen() {
  "$vm/lcm_tap" 300 >"$work/heard" &
  within 20 grep -q '^ready' "$work/heard"
}
count_poses() { grep -c '^pose .*state=4 ' "$work/heard"; }
has_poses() { [[ $(count_poses) -ge $1 ]]; }
# poses_go_on N SECONDS: N further localized poses within that time.
poses_go_on() {
  local before
  before=$(count_poses)
  within "$2" has_poses $((before + $1))
}

# configure LINE...: settings of the daemon on top of the installed file.
configure() { printf '%s\n' "$@" >"$config"; }
# A generated room and its map, as slow as an emulated processor is.
use_sample_room() {
  cp "$vm/sample.cmap" "$map.new" && mv "$map.new" "$map"
  configure '[source]' 'url = "sample://?width=320&height=240&rate_hz=2"' '[localize]' 'features = 300'
}

# unit_setting LINE: in a drop-in for the unit's section [Service], for this boot; none: as installed.
unit_setting() {
  local folder=/run/systemd/system/camlocd.service.d
  rm -rf "$folder"
  if [[ $# -gt 0 ]]; then
    mkdir -p "$folder"
    printf '[Service]\n%s\n' "$@" >"$folder/test.conf"
  fi
  systemctl daemon-reload
}

main_pid() { systemctl show -p MainPID --value camlocd; }
is_active() { systemctl is-active --quiet camlocd; }

# wants_source SCHEME: skips where this build has no such frame source.
wants_source() {
  grep -q "^$1$" "$vm/sources" || skip "this build has no $1://"
}

# video_node DRIVER: the device file of its first camera.
video_node() {
  local node
  for node in /sys/class/video4linux/video*; do
    if [[ $(basename "$(readlink -f "$node/device/driver")") == "$1" ]]; then echo "/dev/$(basename "$node")" && return; fi
  done
}
has_video_node() { [[ -c $(video_node "$1") ]]; }
