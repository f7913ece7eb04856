# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The virtual machine's disk: a minimal system of the distribution with systemd, the packages just built, and the scenarios.
# Sourced by tests/vm/run.

# What scenarios call themselves; what camloc needs is asked of its packages.
base_packages=(systemd systemd-sysv udev dbus kmod v4l-utils iproute2)

# What the packages are expected to depend on, so that the base system can be fetched before they are built. What is missing here is
# fetched all the same, only later.
expected_packages=(libjpeg62-turbo liblcm1 libpng16-16 libstdc++6 libusb-1.0-0 libxxhash0 libyaml-cpp0.7
  libc6 libgcc-s1)

# The machine's own Debian repositories, as lines of a sources.list.
debian_sources() {
  # shellcheck disable=SC2016 # apt fills these in
  apt-get indextargets --format '$(ORIGIN)|deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' | sed -n 's/^Debian|//p' | sort -u
}

# dependencies_of DEB...: names of the packages they depend on, without versions; the last of alternatives.
dependencies_of() {
  local deb
  for deb in "$@"; do dpkg-deb -f "$deb" Depends; done | tr ',' '\n' | sed 's/.*|//; s/(.*//; s/:any//; s/[[:space:]]//g' | grep -v '^camloc' | sort -u
}

# get_base_root CACHE [DEB...]: makes CACHE/root-KEY.tar, a system with everything but the packages themselves, and sets $base_root.
# False with a reason in $reason.
get_base_root() {
  local cache=$1 include key
  # Never opened here: what translates, what explains.
  local slim='rm -rf usr/share/locale usr/share/doc/lib* usr/share/man var/cache/apt/*.bin usr/lib/udev/hwdb.bin'
  shift
  include=$(printf '%s\n' "${base_packages[@]}" "${expected_packages[@]}" $(dependencies_of "$@") | sort -u | paste -sd, -)
  key=$(printf '%s' "$include $slim" | sha256sum | cut -c1-16)
  base_root=$cache/root-$key.tar
  [[ -f $base_root ]] && return 0
  bootstrap "$base_root" --include="$include" --aptopt='APT::Install-Recommends "false"' --customize-hook="cd \"\$1\" && $slim"
}

# get_bare_root CACHE: makes CACHE/bare.tar, a system with nothing but apt and its package lists, and sets $bare_root. False as above.
get_bare_root() {
  bare_root=$1/bare.tar
  # After a week, the lists name packages that are no longer there.
  [[ -n $(find "$bare_root" -mtime -7 2>/dev/null) ]] || bootstrap "$bare_root" --skip=cleanup/apt/lists
}

# bootstrap TAR OPTION...: a minimal system from the machine's own repositories, through its proxy. False with a reason in $reason.
bootstrap() {
  local tar=$1 proxy options=()
  shift
  command -v mmdebstrap >/dev/null || { reason="needs mmdebstrap"; return 1; }
  mkdir -p "$(dirname "$tar")"
  while read -r proxy; do options+=(--aptopt="$proxy"); done < <(apt-config dump 2>/dev/null | grep -E '^Acquire::https?::Proxy' | tr -d '\n' | sed 's/;/;\n/g')
  if ! debian_sources | mmdebstrap --quiet --variant=minbase --dpkgopt=force-unsafe-io --aptopt='Acquire::Languages "none"' "$@" "${options[@]}" \
    "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$tar.$$.tar" - >"$tar.log" 2>&1; then
    reason="mmdebstrap failed: $(tail -n 1 "$tar.log")"
    rm -f "$tar.$$.tar"
    return 1
  fi
  mv "$tar.$$.tar" "$tar"
}

# install_packages ROOT DEB...: with the maintainer scripts, as on a machine whose init is not running.
install_packages() {
  local root=$1
  shift
  mkdir -p "$root/root/packages"
  cp "$@" "$root/root/packages/"
  chroot "$root" /usr/bin/env PATH=/usr/sbin:/usr/bin:/sbin:/bin sh -c 'dpkg -i /root/packages/*.deb' 2>&1
}

# add_scenarios ROOT FOLDER: the guest's side, started by systemd once the system is up.
add_scenarios() {
  local root=$1 folder=$2
  cp -r "$folder" "$root/root/vm"
  cat >"$root/etc/systemd/system/scenarios.service" <<'UNIT'
[Unit]
Description=Scenarios
After=multi-user.target
[Service]
Type=idle
ExecStart=/bin/bash /root/vm/run
StandardOutput=null
Environment=HOME=/root
SuccessAction=poweroff-force
FailureAction=poweroff-force
UNIT
  mkdir -p "$root/etc/systemd/system/default.target.wants"
  ln -s ../scenarios.service "$root/etc/systemd/system/default.target.wants/"
  # multi-user.target is the default, without logins and chores that only cost time here.
  ln -sf /lib/systemd/system/multi-user.target "$root/etc/systemd/system/default.target"
  local unit
  for unit in getty.target apt-daily.timer apt-daily-upgrade.timer dpkg-db-backup.timer e2scrub_all.timer fstrim.timer \
    systemd-timesyncd.service e2scrub_reap.service systemd-update-utmp.service systemd-random-seed.service man-db.timer logrotate.timer; do
    ln -sf /dev/null "$root/etc/systemd/system/$unit"
  done
  # A machine of its own that was booted before: on a first boot systemd would enable every unit.
  tr -d - </proc/sys/kernel/random/uuid >"$root/etc/machine-id"
  : >"$root/etc/fstab"
}
