# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# A daemon that hangs is killed by the watchdog and started again; one that merely waits is left alone. A killed one comes back, too.
limit=$((4 * patience))
use_sample_room
unit_setting WatchdogSec=$limit
systemctl restart camlocd
listen
within 30 has_poses 3
before=$(main_pid)
restarts() { systemctl show -p NRestarts --value camlocd; }
kill -STOP "$before"
restarted() { is_active && [[ $(main_pid) != "$before" && $(main_pid) != 0 ]]; }
within 30 restarted
journalctl -u camlocd -n 50 -o cat | grep -q 'Watchdog timeout' || fail "the watchdog was not the reason: $(journalctl -u camlocd -n 20 -o cat)"
[[ $(restarts) -ge 1 ]] || fail "not counted as a restart"
poses_go_on 3 30

before=$(main_pid)
kill -KILL "$before"
within 20 restarted
poses_go_on 3 30

# No camera for longer than the watchdog's time.
configure '[source]' 'url = "replay:///nowhere"'
systemctl restart camlocd
before=$(main_pid)
sleep $((limit + 2))
is_active && [[ $(main_pid) == "$before" ]] || fail "killed while waiting for a camera"
