# SPDX-License-Identifier: BSD-3-Clause
# Sourced by tests that need a fresh Debian 12: makes one in $root, which goes when the process ends.
# shellcheck shell=bash disable=SC2034  # variables are for those who source this

say() { printf '%s: %s\n' "$told_as" "$*"; }
die() { printf '%s: %s\n' "$told_as" "$*" >&2; exit 1; }

# own_mounts "$0" argument...: mounts made from here on end with this process.
own_mounts() {
    [ "$(id -u)" -eq 0 ] || die "needs root"
    [ -n "${JINK_OWN_MOUNTS:-}" ] || exec unshare --mount env JINK_OWN_MOUNTS=yes "$@"
}

end_fresh_debian() {
    umount "$root/proc" "$root/dev/pts" 2>/dev/null || true
    rm -rf --one-file-system "$root"
}

# fresh_debian [BASE.tar]: a minimal Debian 12, unpacked or made by debootstrap.
fresh_debian() {
    local base=${1:-} mirror
    root=$(mktemp -d "${TMPDIR:-/var/tmp}/jink-chroot.XXXXXX")
    trap end_fresh_debian EXIT
    chmod 755 "$root"  # services' users have to reach it
    mirror=$(apt-cache policy libc6 | sed -n 's/^ *[0-9-]* \(https\?:[^ ]*debian\) .*/\1/p' | head -n 1)
    mirror=${mirror:-http://deb.debian.org/debian}
    if [ -n "$base" ]; then
        say "Debian 12 of $base"
        tar -x --numeric-owner -f "$base" -C "$root" --exclude='./dev/*'
    else
        say "Debian 12 from $mirror"
        debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.log" 2>&1 || { tail -n 20 "$root.log"; die "debootstrap failed"; }
        rm -f "$root.log"
    fi
    echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io"  # a power cut costs nothing here
    [ -e "$root/dev/null" ] || mknod -m 666 "$root/dev/null" c 1 3
    [ -e "$root/dev/urandom" ] || mknod -m 666 "$root/dev/urandom" c 1 9
    mount -t proc proc "$root/proc"
    mkdir -p "$root/dev/pts"
    mount --bind /dev/pts "$root/dev/pts"
    printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"  # nothing is started in here
    chmod +x "$root/usr/sbin/policy-rc.d"
}

in_root() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive HOME=/root chroot "$root" "$@"; }
apt() { in_root apt-get -q -y -o APT::Sandbox::User=root -o Acquire::Retries=3 "$@" >"$root/tmp/apt.log" 2>&1 ||
    { tail -n 30 "$root/tmp/apt.log"; die "apt-get $* failed"; }; }
