# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# `systemctl stop` takes less than a second and leaves nothing behind. The journal's stamps are taken, because systemctl alone needs
# longer than that to start on a slow processor; and the frame under way, which a stop waits for, is made a light one.
unit_setting WatchdogSec=60
use_sample_room
configure '[source]' 'url = "sample://?width=320&height=240&rate_hz=2"' '[localize]' 'features = 100'
systemctl restart camlocd
has_frames() { [[ $(counter frames_received) -ge 3 ]]; }
within 30 has_frames
systemctl stop camlocd
# stamp_ms WORD: when the manager last wrote it about the unit.
stamp_ms() { journalctl -u camlocd -o short-unix --no-pager | sed -n "s/^\([0-9]*\)\.\([0-9]\{3\}\)[0-9]* .* systemd\[1\]: $1 camlocd.*/\1\2/p" | tail -n 1; }
started=$(stamp_ms Stopping) ended=$(stamp_ms Stopped)
[[ -n $started && -n $ended ]] || fail "the journal does not say when it stopped"
took=$((ended - started))
say "systemctl stop took $took ms"
[[ $took -lt $((500 * patience)) ]] || fail "stop took $took ms"
[[ $(systemctl show -p Result --value camlocd) == success ]] || fail "result $(systemctl show -p Result --value camlocd)"
[[ ! -e /run/camloc ]] || fail "/run/camloc stays"
