# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# A machine without a network has no multicast route; camloc-multicast gives it one, and the running daemon takes it up by itself.
! ip route show 224.0.0.0/4 | grep -q . || fail "there is a route already"
systemctl enable --now camloc-multicast
ip route show 224.0.0.0/4 | grep -q 'dev lo' || fail "no route: $(ip route)"
listen
within 20 grep -q '^status ' "$work/heard"
systemctl stop camloc-multicast
! ip route show 224.0.0.0/4 | grep -q . || fail "the route stays after the unit"
systemctl start camloc-multicast
