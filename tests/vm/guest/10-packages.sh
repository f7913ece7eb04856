# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# What the package left on the system: user, groups, folders, a unit that is there but not enabled, nothing that complains.
[[ $(dpkg-query -W -f='${db:Status-Abbrev}' camloc) == "ii " ]] || fail "camloc is not installed"
getent passwd camloc | grep -q ':/usr/sbin/nologin$' || fail "no user camloc, or one that can log in"
[[ $(stat -c '%U:%G %a' /var/lib/camloc) == "root:camloc 2775" ]] || fail "/var/lib/camloc is $(stat -c '%U:%G %a' /var/lib/camloc)"
[[ $(systemctl is-enabled camlocd) == disabled ]] || fail "the service is enabled by its installation"
! is_active || fail "the service runs without having been asked to"
complaints=$(systemd-analyze verify --man=no camlocd.service camloc-camera.target camloc-multicast.service 2>&1 | grep camloc || true)
[[ -z $complaints ]] || fail "$complaints"
[[ -z $(systemctl --failed --no-legend) ]] || fail "$(systemctl --failed --no-legend)"
camlocd --check-config || fail "the installed configuration is not right"
