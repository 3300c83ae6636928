#!/usr/bin/env bash
# Installs the package with apt into a new Debian root and looks at it there. Slow (a debootstrap),
# as root, with network: not among the tests.
#   tests/package/clean_root.sh binpick_0.1.0_amd64.deb [SUITE]
set -euo pipefail

package=$(readlink -f "$1")
suite=${2:-bookworm}
root=$(mktemp -d)
trap 'umount -q "$root/proc" || true; rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase "$suite" "$root" >/dev/null
mount -t proc proc "$root/proc"
cp "$package" "$root/tmp/"
in_root() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C "$@"; }
in_root apt-get -qq install --yes --no-install-recommends "/tmp/$(basename "$package")"
in_root systemd-analyze verify --recursive-errors=no binpickd.service
in_root systemd-analyze security --offline=true --threshold=20 --no-pager binpickd.service
in_root binpickd --version
in_root binpick --version
in_root id binpick
in_root stat -c '%U:%G %a %n' /var/lib/binpick/recordings /etc/binpick
in_root sh -c 'binpickd --check --config /usr/share/binpick/binpick.toml; test $? -eq 78'
in_root apt-get -qq purge --yes binpick
in_root sh -c 'test ! -e /usr/bin/binpickd && test ! -e /var/lib/binpick/recordings'
echo "clean_root: installed, verified, purged"
