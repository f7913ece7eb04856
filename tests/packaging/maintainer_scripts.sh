#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The scripts of the package, run with stand-ins for the programs they call: what they ask for at each step, and that a failure
# of systemctl or udev does not break an installation. The whole life of a package on a running system is in tests/vm.
. "$(dirname "$0")/lib.sh"
scripts=$source_folder/packaging
stand_ins=$scratch/bin
mkdir -p "$stand_ins"
for program in systemd-sysusers systemd-tmpfiles deb-systemd-helper deb-systemd-invoke systemctl udevadm; do
  printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\nexit ${STAND_IN_EXIT:-0}\n' $program "$scratch" >"$stand_ins/$program"
done
chmod +x "$stand_ins"/*

# run SCRIPT ARGUMENT...: its calls are in $scratch/calls
run() {
  local script=$1
  shift
  : >"$scratch/calls"
  PATH=$stand_ins:$PATH sh -eu "$scripts/camloc.$script" "$@" || fail "$script $* ends with $?"
}
calls() { grep -q -- "$1" "$scratch/calls" || fail "$2 does not call '$1' but: $(cat "$scratch/calls")"; }
calls_not() { ! grep -q -- "$1" "$scratch/calls" || fail "$2 calls '$1'"; }

for script in postinst prerm postrm; do sh -n "$scripts/camloc.$script" || fail "$script is no shell script"; done

run postinst configure ""
calls "systemd-sysusers camloc.conf" "the first installation"
calls "systemd-tmpfiles --create camloc.conf" "the first installation"
calls "update-state camlocd.service" "the first installation"
calls_not "restart" "the first installation"
calls_not "systemctl enable" "the first installation"
run postinst configure 0.0.9
calls "systemd-sysusers" "an upgrade"
run postinst triggered
[[ ! -s $scratch/calls ]] || fail "postinst does something when it has nothing to do"
run prerm upgrade 0.2.0
calls_not "stop" "an upgrade, before unpacking"
run postrm remove
calls_not "purge" "remove"
[[ -d /etc/camloc || -d /var/lib/camloc ]] && { echo "camloc is installed here: purge is not tried"; finish; }
run postrm purge
calls "deb-systemd-helper purge camlocd.service" "purge"

# Services that cannot be asked: the installation goes on. Without the user there is none.
printf '#!/bin/sh\nexit 0\n' | tee "$stand_ins/systemd-sysusers" >"$stand_ins/systemd-tmpfiles"
STAND_IN_EXIT=1 run postinst configure 0.0.9
printf '#!/bin/sh\nexit 1\n' >"$stand_ins/systemd-sysusers"
PATH=$stand_ins:$PATH sh -e "$scripts/camloc.postinst" configure "" 2>/dev/null && fail "an installation without its user succeeds"
finish
