#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# What a bare Debian system has to take on: for each package and for the demo, how many packages apt adds (without those that are only
# recommended) and how large they are when installed. The device's package is really installed there, and its programs start.
# The system is made by mmdebstrap once and kept with those of tests/vm; the numbers are in the README.
. "$(dirname "$0")/lib.sh"
export PATH=$PATH:/usr/sbin:/sbin LC_ALL=C.UTF-8
# shellcheck source=tests/vm/root_image.sh
. "$source_folder/tests/vm/root_image.sh"
[[ $(id -u) -eq 0 ]] || skip "needs root, to unpack a system"
for program in mmdebstrap dpkg-shlibdeps; do
  command -v "$program" >/dev/null || skip "needs $program; tools/install-deps --tests installs it"
done

(cd "$scratch" && cpack --config "$build/CPackConfig.cmake" -B "$scratch/packages" >"$scratch/cpack.log" 2>&1) ||
  { fail "cpack: $(tail -n 3 "$scratch/cpack.log")"; finish; }
get_bare_root "$source_folder/build/vm/cache" || skip "$reason"
root=$scratch/root
mkdir "$root"
tar -C "$root" -xf "$bare_root" || skip "cannot unpack a system here"
mkdir "$root/packages"
cp "$scratch"/packages/camloc*.deb "$root/packages/"

in_root() { chroot "$root" /usr/bin/env PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
apt_get() { in_root apt-get -qq --no-install-recommends "$@"; }

# weigh WHAT NUM_PACKAGES MEGABYTES PACKAGE...: sets $added to what comes along, and says whether that is more than it may be.
weigh() {
  local what=$1 most=$2 most_mb=$3 kb num
  shift 3
  added=''
  apt_get -s install "$@" >"$scratch/simulated" 2>&1 || { fail "$what cannot be installed: $(tail -n 3 "$scratch/simulated")"; return; }
  added=$(sed -n 's/^Inst \([^ ]*\) .*/\1/p' "$scratch/simulated")
  num=$(wc -w <<<"$added")
  # shellcheck disable=SC2046,SC2086 # words
  kb=$({ in_root apt-cache show --no-all-versions $(grep -v '^camloc' <<<"$added"); for deb in "$root"/packages/*.deb; do
    if grep -qx "$(dpkg-deb -f "$deb" Package)" <<<"$added"; then dpkg-deb -f "$deb" Installed-Size | sed 's/^/Installed-Size: /'; fi
  done; } | awk '/^Installed-Size: / { sum += $2 } END { print sum + 0 }')
  echo "$what: $num packages, $((kb / 1000)) MB"
  [[ $num -gt 0 && $num -le $most && $kb -le $((most_mb * 1000)) ]] || fail "$what: more than $most packages or $most_mb MB: "$added
}
deb_of() { echo /packages/"$(basename "$root/packages/$1"_*.deb)"; }

unwanted='^lib(opencv|llvm|x11|gl1|glx|qt|gdal)|mesa'
weigh camloc 17 25 "$(deb_of camloc)"
! grep -iE "$unwanted" <<<"$added" || fail "camloc brings the above with it"
weigh camloc-tools 75 100 "$(deb_of camloc-tools)"
! grep -iE "$unwanted" <<<"$added" || fail "camloc-tools brings the above with it"
for package in camloc-bench camloc-calibration camloc-coarse; do
  if [[ -e $root$(deb_of $package) ]]; then weigh $package 220 600 "$(deb_of $package)"; fi
done
# Debian's libtorch comes with OpenCV's video modules and what those want.
if [[ -e $root$(deb_of camloc-training) ]]; then weigh camloc-training 340 950 "$(deb_of camloc-training)"; fi
# shellcheck disable=SC2046 # words
weigh tools/demo 190 800 $("$source_folder/tools/install-deps" --list)
# With systemd in the same breath it is systemd that makes the user and the folders.
apt_get -s install "$(deb_of camloc)" systemd | grep -q '^Inst systemd ' || fail "camloc does not go with systemd"

if apt_get install "$(deb_of camloc)" >"$scratch/install.log" 2>&1; then
  in_root camlocd --version >/dev/null && in_root camloc --version >/dev/null || fail "the programs do not start"
  in_root id camloc >/dev/null || fail "the package makes no user"
else
  fail "camloc does not install: $(tail -n 3 "$scratch/install.log")"
fi
finish
