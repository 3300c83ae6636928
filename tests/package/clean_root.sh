#!/usr/bin/env bash
# Installs the package with apt into a new Debian root and uses it there: units verified, a part
# trained, the daemon started as its user on the package's own configuration, asked by its PLC tool,
# stopped, purged. Minutes (a debootstrap), as root, with network: not among the tests.
#   tests/package/clean_root.sh binpick_0.1.0_amd64.deb [SUITE]
# Packages come from where apt on this machine has them.
set -euo pipefail

package=$(readlink -f "$1")
suite=${2:-bookworm}
sample=$(readlink -f "$(dirname "$0")/../data/bin-sample")
mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
  awk -v suite="$suite" '$1 == "Debian" && $2 == suite { print $3; exit }')
[[ -n $mirror ]] || { echo "clean_root: apt knows no Debian $suite" >&2; exit 1; }

root=$(mktemp -d)
chmod 755 "$root"  # for apt, which reads as a user of its own
daemon=
finish() {
  [[ -z $daemon ]] || kill "$daemon" 2>/dev/null || true
  umount -q "$root/proc" || true
  rm -rf --one-file-system "$root"
}
trap finish EXIT
step() { echo "clean_root: $*"; }
there=(chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C
  DEBIAN_FRONTEND=noninteractive ${http_proxy:+http_proxy="$http_proxy"})
station=("${there[@]}" setpriv --reuid=binpick --regid=binpick --init-groups)
in_root() { "${there[@]}" "$@"; }
as_station() { "${station[@]}" "$@"; }

step "Debian $suite from $mirror"
debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" ||
  { tail "$root.log" >&2; exit 1; }
rm "$root.log"
mount -t proc proc "$root/proc"
cp "$package" "$root/tmp/"
in_root apt-get -qq update
in_root apt-get -qq -o Dpkg::Use-Pty=0 install --yes --no-install-recommends \
  "/tmp/$(basename "$package")" >/dev/null
step "installed"

in_root systemd-analyze verify --recursive-errors=no binpickd.service
in_root systemd-analyze security --offline=true --threshold=20 --no-pager binpickd.service |
  tail -n 1
in_root id binpick
in_root stat -c '%U:%G %a %n' /var/lib/binpick/recordings /etc/binpick
in_root binpickd --version
in_root sh -c 'binpickd --check --config /usr/share/binpick/binpick.toml; test $? -eq 78'

# A cell as an integrator sets it up, but for the sensor, the port and what this root cannot grant.
mkdir -p "$root/srv"
cp -r "$sample" "$root/srv/bins"
in_root binpick train /srv/bins/models/obj_000001.ply -o /etc/binpick/tee.bpm --unit mm \
  --camera /srv/bins/camera.json --distance-mm 710:770 --samples 50 \
  --calibration-piles 0 --test-piles 0 >/dev/null 2>&1
sed -e 's|^uri = .*|uri = "replay:/srv/bins"|' -e 's|^recipes = .*|recipes = ["tee.toml"]|' \
  -e 's|^port = .*|port = 15020|' -e 's|^bind = .*|bind = "127.0.0.1"|' \
  -e 's|^lock_required = .*|lock_required = false|' \
  -e 's|^folder = .*|folder = "/var/lib/binpick/recordings"|' -e 's|^mode = .*|mode = "always"|' \
  "$root/usr/share/binpick/binpick.toml" >"$root/etc/binpick/binpick.toml"
sed -e 's|^number = .*|number = 1|' -e 's|^models = .*|models = ["tee.bpm"]|' \
  "$root/usr/share/binpick/recipes/example.toml" >"$root/etc/binpick/tee.toml"
in_root binpickd --check
in_root binpickd --plan | tail -n 1
in_root install -d -o binpick -g binpick -m 0750 /run/binpick  # the unit's RuntimeDirectory=
"${station[@]}" binpickd >"$root/tmp/log" 2>&1 &  # its own process, not a shell's around it
daemon=$!
for ((i = 0; i < 100; ++i)); do
  ! as_station binpick trigger status 2>/dev/null | grep -q '"sensor":"ready"' || break
  sleep 0.1
done
as_station binpick trigger detect | head -n 1
in_root binpick plc --host 127.0.0.1 --port 15020 --soak 20 --timeout-ms 60000
kill "$daemon"
wait "$daemon" || { cat "$root/tmp/log" >&2; exit 1; }
daemon=
recording=$(in_root sh -c 'ls -d /var/lib/binpick/recordings/*' | head -n 1)
as_station binpick replay "$recording"
step "served and stopped"

in_root apt-get -qq -o Dpkg::Use-Pty=0 purge --yes binpick >/dev/null
in_root sh -c 'test ! -e /usr/bin/binpickd && test ! -e /var/lib/binpick/recordings'
step "purged"
