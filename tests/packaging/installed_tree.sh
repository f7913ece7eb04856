#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Everything a user is told about is installed where it is said to be, and pkg-config leads to message types that lcm-gen takes.
. "$(dirname "$0")/lib.sh"
install_tree
cd "$scratch/root" || exit 1

for file in etc/camloc/camlocd.toml usr/bin/{camlocd,camloc,camloc-map,camloc-camera,camloc-bench,camloc-sim,camloc-train} usr/share/camloc/cameras/kinect-v1.toml \
  usr/lib/systemd/system/{camlocd.service,camloc-camera.target,camloc-multicast.service} usr/lib/udev/rules.d/60-camloc.rules \
  usr/lib/{sysusers,tmpfiles}.d/camloc.conf usr/share/man/man8/camlocd.8.gz usr/share/man/man5/camlocd.toml.5.gz \
  usr/share/bash-completion/completions/camloc usr/share/doc/camloc/{copyright,changelog.gz,examples/realtime.conf} \
  usr/share/doc/camloc-{tools,calibration,bench,training,coarse}/copyright usr/lib/*/camloc/camloc-opencv-dnn.so \
  usr/share/pkgconfig/camloc-lcmtypes.pc; do
  [[ -s $file ]] || fail "/$file is not installed"
done
[[ -d etc/camloc/camlocd.toml.d ]] || fail "no folder for settings in pieces"
for program in usr/bin/*; do
  pages=(usr/share/man/man*/"$(basename "$program")".*.gz)
  [[ -s ${pages[0]} ]] || fail "no manual page for $program"
  [[ -s usr/share/bash-completion/completions/$(basename "$program") ]] || fail "no completion for $program"
done
cmp -s etc/camloc/camlocd.toml <(usr/bin/camlocd --config /dev/null --print-config) || fail "the installed configuration is not the default"

# A subscriber's way from the package to a header.
export PKG_CONFIG_PATH=$scratch/root/usr/share/pkgconfig
types=$(pkg-config --variable=lcmtypesdir camloc-lcmtypes)
[[ $types == /usr/share/camloc/lcmtypes ]] || fail "pkg-config says lcmtypesdir=$types"
lcm-gen -x --cpp-hpath="$scratch/generated" "$scratch/root$types"/*.lcm || fail "lcm-gen refuses the message types"
for type in pose_t status_t pose_hint_t; do [[ -s $scratch/generated/camloc/$type.hpp ]] || fail "no header for $type"; done

# Nothing refers to the folders it was built in.
if grep -rlIF -e "$build" -e "$source_folder" .; then fail "the files above name the build or source folder"; fi
finish
