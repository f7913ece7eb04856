# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The distribution's own kernel for the virtual machine, without installing it: image, the few modules that the scenarios need,
# and an initial file system that mounts the disk. Sourced by tests/vm/run.

# The plain kernel: the one for clouds has neither USB nor cameras.
kernel_modules=(virtio_pci virtio_blk crc32c_generic ext4 ehci_pci gspca_kinect vivid uvcvideo)

# get_kernel CACHE: puts vmlinuz and modules/lib/modules/VERSION there, and sets kernel_version. False with a reason in $reason.
get_kernel() {
  local cache=$1 package folder module file
  package=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/^ *Depends: \(linux-image-[0-9].*\)$/\1/p' | head -n 1)
  [[ -n $package ]] || { reason="apt knows no linux-image-amd64"; return 1; }
  kernel_version=${package#linux-image-}
  [[ -f $cache/$kernel_version.complete ]] && return 0
  rm -rf "$cache"
  mkdir -p "$cache/all" "$cache/modules"
  (cd "$cache/all" && apt-get download -q "$package" >download.log 2>&1) || { reason="cannot download $package"; return 1; }
  dpkg-deb --fsys-tarfile "$cache/all/$package"_*.deb | tar -x -C "$cache/all" ./boot ./lib/modules || { reason="cannot unpack $package"; return 1; }
  mv "$cache/all/boot/vmlinuz-$kernel_version" "$cache/vmlinuz"
  depmod -b "$cache/all" "$kernel_version"
  for module in "${kernel_modules[@]}"; do
    for file in $(modprobe -d "$cache/all" -S "$kernel_version" --show-depends "$module" | sed -n 's/^insmod \([^ ]*\).*/\1/p'); do
      folder=$cache/modules/$(dirname "${file#"$cache/all/"}")
      mkdir -p "$folder" && cp "$file" "$folder"
    done
  done
  cp "$cache/all/lib/modules/$kernel_version"/modules.{builtin,builtin.modinfo,order} "$cache/modules/lib/modules/$kernel_version"
  depmod -b "$cache/modules" "$kernel_version"
  rm -rf "$cache/all"
  touch "$cache/$kernel_version.complete"
}

# make_initramfs CACHE FILE: just enough to mount /dev/vda and go on there.
make_initramfs() {
  local cache=$1 out=$2 tree
  tree=$(mktemp -d)
  mkdir -p "$tree"/{bin,proc,sys,dev,root,lib}
  cp "$(command -v busybox)" "$tree/bin/busybox"
  cp -a "$cache/modules/lib/modules" "$tree/lib/"
  # Cameras and USB are loaded by udev, from the disk.
  rm -rf "$tree/lib/modules/$kernel_version/kernel/drivers"/{media,usb}
  cat >"$tree/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc && mount -t sysfs sysfs /sys && mount -t devtmpfs dev /dev
for module in virtio_pci virtio_blk crc32c_generic ext4; do modprobe $module; done
tries=0
while [ ! -b /dev/vda ] && [ $tries -lt 100 ]; do sleep 0.1; tries=$((tries + 1)); done
mount -t ext4 /dev/vda /root || poweroff -f
for folder in proc sys dev; do mount --move /$folder /root/$folder; done
exec switch_root /root /lib/systemd/systemd
INIT
  chmod +x "$tree/init"
  (cd "$tree" && find . | cpio -o -H newc --quiet | gzip -1) >"$out"
  rm -rf "$tree"
}
