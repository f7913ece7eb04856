# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Poses of the sandboxed service reach a subscriber; a good map is taken on `systemctl reload`, a bad one refused with the reason,
# and the old one stays in use.
unit_setting WatchdogSec=60
use_sample_room
systemctl restart camlocd
listen
within 30 has_poses 5
map_id() { grep '^pose ' "$work/heard" | tail -n 1 | grep -o 'map=[0-9a-f]*'; }
first=$(map_id)

cp "$vm/other.cmap" "$map.new" && mv "$map.new" "$map"
systemctl reload camlocd || fail "a good map is refused"
poses_go_on 3 20
second=$(map_id)
[[ $first != "$second" ]] || fail "reload did not open the new map"

head -c 5000 "$vm/sample.cmap" >"$map.new" && mv "$map.new" "$map"
! systemctl reload camlocd 2>"$work/reload" || fail "reload says that a damaged map is fine"
is_active || fail "a bad map ended the service"
journalctl -u camlocd -n 20 -o cat | grep -q "$map" || fail "the journal does not name the bad map"
poses_go_on 3 20
[[ $(map_id) == "$second" ]] || fail "not the old map"
