#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# systemd understands the units without a complaint, as they are and with the drop-in for real-time priority, and rates the
# sandbox at most 1.5 of 10.
. "$(dirname "$0")/lib.sh"
command -v systemd-analyze >/dev/null || skip "needs systemd-analyze (package systemd)"
install_tree
root=$scratch/root
units=$root/usr/lib/systemd/system
# What the units name from the rest of a system.
mkdir -p "$root/bin" "$root/etc"
cp "$(type -P true)" "$root/bin/ip"
printf 'root:x:0:0::/root:/bin/sh\ncamloc:x:900:900::/:/usr/sbin/nologin\n' >"$root/etc/passwd"
printf 'root:x:0:\ncamloc:x:900:\nplugdev:x:46:\nvideo:x:44:\n' >"$root/etc/group"
for unit in sysinit.target basic.target network.target multi-user.target shutdown.target local-fs.target; do
  printf '[Unit]\nDescription=%s\nDefaultDependencies=no\n' $unit >"$units/$unit"
done

# The system's own units and mounts are named, too, by some versions; only what is said about ours counts.
verify() { systemd-analyze verify --root="$root" --man=no camlocd.service camloc-camera.target camloc-multicast.service 2>&1 | grep camloc; }
complaints=$(verify)
[[ -z $complaints ]] || fail "systemd-analyze verify: $complaints"
mkdir -p "$root/etc/systemd/system/camlocd.service.d"
cp "$root/usr/share/doc/camloc/examples/realtime.conf" "$root/etc/systemd/system/camlocd.service.d/"
complaints=$(verify)
[[ -z $complaints ]] || fail "with realtime.conf: $complaints"
# That it would have complained.
printf '[Service]\nNoSuchSetting=1\n' >"$root/etc/systemd/system/camlocd.service.d/wrong.conf"
[[ -n $(verify) ]] || fail "systemd-analyze verify does not see a wrong setting"

for unit in camlocd camloc-multicast; do
  report=$(systemd-analyze security --offline=true --no-pager --threshold=15 "$units/$unit.service" 2>&1) || fail "exposure of $unit is above 1.5: $report"
  tail -n 1 <<<"$report"
done
finish
