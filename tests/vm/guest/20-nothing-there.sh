# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Enabled with neither camera nor map nor multicast route: active, and it says what it waits for. The journal has its log with
# priorities, and the sandbox is as tight on the running service as it looks in the file.
rm -f "$config"
start=$(date +%s%N)
systemctl enable --now camlocd
say "systemctl enable --now took $((($(date +%s%N) - start) / 1000000)) ms"
is_active || fail "not active"
[[ $(systemctl show -p User --value camlocd) == camloc ]] || fail "not its own user"
[[ $(ps -o user= -p "$(main_pid)" 2>/dev/null || stat -c %U "/proc/$(main_pid)") == camloc ]] || fail "runs as somebody else"
within 10 status_has '"state":"NO_'
systemctl status --no-pager -n 4 camlocd | sed 's/^/# | /' >&3
systemctl status --no-pager camlocd | grep -q 'Status: "' || fail "systemctl status has no words for the state"
journalctl -u camlocd -o json -n 1 | grep -q '"PRIORITY"' || fail "no priorities in the journal"
exposure=$(systemd-analyze security --no-pager camlocd | tail -n 1)
say "$exposure"
[[ $(grep -oE '[0-9]+\.[0-9]' <<<"$exposure" | tr -d .) -le 15 ]] || fail "$exposure"
! camloc doctor >"$work/doctor" 2>&1 || fail "doctor finds nothing wrong"
sed 's/^/# | /' "$work/doctor" >&3
