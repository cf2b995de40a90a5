#!/bin/bash
# run.sh PROGRAM... -- COMMAND: runs a command in an emulated machine whose time is its own.
#
# Problem. A device that is felt needs a real kernel, a real /dev/hidraw and deadlines of a fraction
# of a millisecond; a test machine has no such device and keeps no such deadline. Here qemu emulates a
# machine with Debian's kernel, where a program plays the device through /dev/uhid. Its clock counts
# instructions (-icount): 5 kHz are 5 kHz however slow or busy the host is.
#
# Everything in PROGRAM... goes into the machine's /bin, with the libraries that it needs (a file
# that is not executable goes to / instead). COMMAND is a line for its busybox sh, run in / as root;
# what it writes, on either stream, comes out here, and its exit code is this script's. There are also
#   await FILE...  waits until each file is there (and a device is readable), 5 s at most
# and a mounted /proc, /sys, /sys/kernel/debug, /dev and /tmp; one processor, 256 MiB.
#
# The kernel is linux-image-KERNEL: cloud-amd64, which has uhid, or with KERNEL=amd64 the one for all
# machines, which starts 4 s later, and has uinput besides.
#
# Exit code 77, and a reason: there is no qemu, or the kernel cannot be downloaded. The kernel (27 or
# 70 MB) is downloaded once, into HAPGRID_BUILD/qemu. No more than TIMEOUT (120) seconds, then 124.
set -euo pipefail

build=$(realpath -m "${HAPGRID_BUILD:-$(dirname "$0")/../../build}")
kernel=${KERNEL:-cloud-amd64}
# In this order: each needs the ones before.
modules=(hid uhid hid-generic)
folders=('*/drivers/hid/*')
if [[ $kernel != cloud-amd64 ]]; then
  modules+=(evdev ff-memless uinput)
  folders+=('*/drivers/input/*')
fi
cache=$build/qemu/$kernel

skip() {
  echo "skipped: $*"
  exit 77
}

programs=()
while (($#)) && [[ $1 != -- ]]; do
  programs+=("$1")
  shift
done
(($# == 2)) || { echo "usage: run.sh PROGRAM... -- COMMAND" >&2; exit 2; }
command=$2

[[ $(uname -m) == x86_64 ]] || skip "the emulated machine is made of this one's programs: x86_64"
for tool in qemu-system-x86_64 cpio dpkg-deb tar apt-get flock; do
  command -v $tool >/dev/null || skip "$tool is not installed"
done
busybox=$(command -v busybox) || skip "busybox is not installed"
! ldd "$busybox" >/dev/null 2>&1 || skip "busybox-static is not installed: $busybox needs libraries"

# The kernel, unpacked as $cache/kernel: a tree that appears as a whole, by a rename.
mkdir -p "$cache"
(
  flock 9
  [[ ! -d $cache/kernel ]] || exit 0
  rm -rf "$cache/download"
  mkdir "$cache/download" && cd "$cache/download" || exit 1  # behind `||` set -e is off
  package=$(apt-cache depends "linux-image-$kernel" 2>/dev/null |
    awk '/Depends: linux-image-[0-9]/ { print $2; exit }')
  [[ -n $package ]] || { echo "apt knows no linux-image-$kernel"; exit 1; }
  timeout 100 apt-get download "$package" >log 2>&1 || { echo "$package: $(tail -n 1 log)"; exit 1; }
  mkdir tree
  dpkg-deb --fsys-tarfile "$package"_*.deb |
    tar -x -C tree --wildcards './boot/vmlinuz*' "${folders[@]}" &&
    mv tree "$cache/kernel" && rm -r "$cache/download"
) 9>"$cache/lock" >"$cache/why.$$" 2>&1 || {
  why=$(cat "$cache/why.$$")
  rm -f "$cache/why.$$"
  skip "the kernel cannot be downloaded: $why"
}
rm -f "$cache/why.$$"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir -p "$root"/{bin,dev,proc,sys,tmp,lib/modules}
cp "$busybox" "$root/bin/busybox"
for applet in $("$busybox" --list); do ln -s busybox "$root/bin/$applet" 2>/dev/null || true; done

for module in "${modules[@]}"; do
  find "$cache/kernel/lib/modules" -name "$module.ko" -exec cp {} "$root/lib/modules/" \;
done

for program in "${programs[@]}"; do
  if [[ ! -x $program ]]; then
    cp "$program" "$root/"
    continue
  fi
  cp --remove-destination "$program" "$root/bin/"  # some have the name of an applet of busybox
  # The libraries with their paths; a static program and a script have none.
  { ldd "$program" 2>/dev/null | grep -oE '/[^ ]+' || true; } | while read -r library; do
    mkdir -p "$root$(dirname "$library")"
    cp -nL "$library" "$root$library"
  done
done

cat >"$root/bin/await" <<'END'
#!/bin/sh
for file; do
  tries=500
  until [ -r "$file" ]; do
    tries=$((tries - 1))
    [ $tries -gt 0 ] || { echo "await: $file is not there after 5 s" >&2; exit 1; }
    usleep 10000
  done
done
END

printf '%s\n' "$command" >"$root/command"
printf '%s\n' "${modules[@]}" >"$root/modules"
# Three serial lines: the command's output, the kernel's log, the exit code.
cat >"$root/init" <<'END'
#!/bin/sh
export PATH=/bin HOME=/tmp HAPGRID_MODEL_PATH=/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t debugfs debugfs /sys/kernel/debug
mount -t devtmpfs devtmpfs /dev 2>/dev/null
mount -t tmpfs tmpfs /tmp
# Whoever asks here for a processor that does not sleep makes this one count instructions while it idles.
rm -f /dev/cpu_dma_latency
exec </dev/null >/dev/ttyS0 2>&1
stty -F /dev/ttyS0 -onlcr
for module in $(cat /modules); do insmod /lib/modules/$module.ko; done
sh /command
echo "exit code $?" >/dev/ttyS2
poweroff -f
END
chmod +x "$root/init" "$root/bin/await"
(cd "$root" && find . | cpio -o -H newc --quiet) >"$work/initrd"

image=$(echo "$cache"/kernel/boot/vmlinuz-*)
# The kernel need not test its ciphers nor read certificates, which would take half of the time until it is there.
options="console=ttyS1 panic=-1 quiet mitigations=off cryptomgr.notests initcall_blacklist=load_system_certificate_list"
code=0
timeout "${TIMEOUT:-120}" qemu-system-x86_64 -accel tcg -icount shift=1,sleep=off -cpu max -m 256 \
  -smp 1 -display none -nodefaults -no-reboot -serial stdio -serial "file:$work/log" -serial "file:$work/code" \
  -kernel "$image" -initrd "$work/initrd" -append "$options" </dev/null || code=$?
if ((code == 124)); then
  echo "run.sh: the machine was stopped after ${TIMEOUT:-120} s" >&2
  exit 124
fi
result=$(sed -nE 's/^exit code ([0-9]+)\r?$/\1/p' "$work/code")
if [[ -z $result ]]; then
  echo "run.sh: the machine died (qemu: $code); the end of its log:" >&2
  tail -n 20 "$work/log" >&2
  exit 1
fi
exit "$result"
