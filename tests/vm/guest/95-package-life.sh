# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Upgrade, remove, install again, purge: the service goes on, a changed configuration is kept, nothing dangles, and no map is lost.
unit_setting
systemctl enable camlocd
systemctl restart camlocd
before=$(main_pid)
echo '# mine' >>/etc/camloc/camlocd.toml
dpkg -i "$vm"/upgrade/camloc_*.deb >"$work/upgrade" 2>&1 || fail "upgrade: $(tail -n 3 "$work/upgrade")"
is_active && [[ $(main_pid) != "$before" ]] || fail "the new version does not run"
grep -q '^# mine' /etc/camloc/camlocd.toml || fail "the upgrade replaced a changed configuration"
[[ $(systemctl is-enabled camlocd) == enabled ]] || fail "the upgrade disabled the service"

dpkg -r camloc >"$work/remove" 2>&1 || fail "remove: $(tail -n 3 "$work/remove")"
! is_active || fail "the service runs on after its program was removed"
[[ ! -e /usr/bin/camlocd && -f /etc/camloc/camlocd.toml && -f $map ]] || fail "remove took too much, or too little"
[[ -z $(systemctl --failed --no-legend) ]] || fail "$(systemctl --failed --no-legend)"

dpkg -i /root/packages/camloc_*.deb >"$work/again" 2>&1 || fail "install again: $(tail -n 3 "$work/again")"
[[ $(systemctl is-enabled camlocd) == enabled ]] || fail "it forgot that it was enabled"
systemctl start camlocd || fail "does not start after it was installed again"

dpkg -P camloc >"$work/purge" 2>&1 || fail "purge: $(tail -n 3 "$work/purge")"
[[ ! -e /etc/camloc/camlocd.toml ]] || fail "purge left the configuration"
[[ -f $map ]] || fail "purge deleted a map"
grep -q '/var/lib/camloc is not empty and stays' "$work/purge" || fail "purge does not say that maps stay"
links=$(find /etc/systemd /run/systemd/system -xtype l -name 'camloc*')
[[ -z $links ]] || fail "links that lead nowhere: $links"
rm -f "$map" "$config"
[[ -z $(systemctl --failed --no-legend) ]] || fail "$(systemctl --failed --no-legend)"
