#!/bin/sh
# fresh-machine.sh [--packages] [DIRECTORY]: prove that malus needs git, make and nothing else.
#
# Makes a minimal Debian 12 root in DIRECTORY (default: a new one below /var/tmp) that holds git and make, clones
# the committed HEAD into it, and types there what the README tells a new user to type. Package sources
# are those of this machine. With --packages the root holds neither: the packages of build/deb, which `make deb` made, are
# installed into it, and their own tests (debian/tests) run there; the wheel of build/wheel is tested before them. Wants root (debootstrap and chroot do) and Debian's package debootstrap.
set -eu
project=$(cd "$(dirname "$0")/.." && git rev-parse --show-toplevel)
packages=
[ "${1:-}" != --packages ] || { packages=yes; shift; }
root=${1:-$(mktemp -d /var/tmp/malus-fresh-XXXXXX)}
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | head -n 1)

# Files in it will be removed and replaced: it must be empty, or made by this script.
mark=.malus-fresh-machine
root=$(realpath -m "$root")
if [ -e "$root" ] && [ ! -e "$root/$mark" ] && [ -n "$(ls -A "$root" 2>/dev/null)" ]; then
  echo "fresh-machine.sh: $root is not empty and not of our making; name an empty directory" >&2
  exit 2
fi

[ "$(id -u)" = 0 ] || { echo "fresh-machine.sh must run as root: chroot needs it" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "debootstrap is missing: apt-get install debootstrap" >&2; exit 2; }

say() { printf '\n== %s\n' "$*"; }
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM="${TERM:-dumb}" LANG=C.UTF-8 sh -ec "$1"; }

if [ ! -e "$root/bin/sh" ]; then
  say "a minimal Debian 12 in $root"
  debootstrap --variant=minbase --include=$([ -n "$packages" ] || echo git,make,)ca-certificates bookworm "$root" "$mirror" >"$root.log" 2>&1 ||
    { tail -n 5 "$root.log" >&2; exit 1; }
  touch "$root/$mark"
fi
rm -f "$root/etc/apt/sources.list"
cp -r /etc/apt/sources.list.d /etc/apt/apt.conf.d "$root/etc/apt/"
cp /etc/resolv.conf "$root/etc/" 2>/dev/null || true
mkdir -p "$root/proc" "$root/dev"
mount -t proc proc "$root/proc" 2>/dev/null && trap 'umount "$root/proc"' EXIT

if [ -n "$packages" ]; then
  mkdir -p "$root/root/packages"
  cp "$project"/build/deb/*.deb "$root/root/packages/"
  cp -r "$project/debian/tests" "$root/root/"
  for wheel in "$project"/build/wheel/*.whl; do
    [ -e "$wheel" ] || continue
    cp "$wheel" "$project/README.md" "$project/tests/wheel.sh" "$root/root/"
    say "${wheel##*/}, without the packages"
    inside "apt-get update -q >/dev/null && apt-get install -y -q python3-venv python3-numpy python3-xarray python3-matplotlib >/root/apt.log 2>&1 || { tail /root/apt.log; exit 1; }
      sh /root/wheel.sh /root/${wheel##*/} /root/README.md"
  done
  say "apt install ./malus_*.deb"
  inside "cd /root/packages && apt-get update -q >/dev/null && apt-get install -y -q ./malus_*.deb >/root/apt.log 2>&1 || { tail /root/apt.log; exit 1; }"
  sed -n 's/^Tests: //p' "$project/debian/tests/control" | while read -r name; do
    wanted=$(grep -A1 "^Tests: $name\$" "$project/debian/tests/control" | sed -n 's/^Depends: //p' | tr -d ,)
    say "debian/tests/$name, with $wanted"
    inside "cd /root/packages && names= && for one in $wanted; do set -- ./\${one}_*.deb; [ -e \"\$1\" ] && one=\$1; names=\"\$names \$one\"; done
      apt-get install -y -q \$names >/root/apt.log 2>&1 || { tail /root/apt.log; exit 1; }
      sh /root/tests/$name"
  done
  exit
fi

say "clone"
rm -rf "$root/root/malus"
git clone -q "file://$project" "$root/root/malus"
for command in "make test" "make" "make"; do
  say "$command"
  inside "cd /root/malus && begin=\$(date +%s) && $command && echo \"($command took \$((\$(date +%s) - begin)) s)\""
done
say "the verdict table once more"
inside "cd /root/malus && ./build/malus reproduce | tail -n 20"
say "$root holds the machine; remove it when you like"
