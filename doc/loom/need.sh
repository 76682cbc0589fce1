#!/bin/sh
# need.sh PACKAGE...: see that these Debian packages are installed; install the missing ones.
# As root with apt-get; otherwise with sudo when it works; otherwise name the line to type and stop.
missing=
for package in "$@"; do
  case "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" in
    "install ok installed") ;;
    *) missing="$missing $package" ;;
  esac
done
[ -z "$missing" ] && exit 0

if ! command -v apt-get >/dev/null; then
  echo "malus needs what Debian 12 calls:$missing" >&2
  echo "There is no apt-get here; install them by your system's own means, then run make NEED=: $MAKECMDGOALS" >&2
  exit 1
fi
line="apt-get install --no-install-recommends$missing"
echo "malus needs these Debian packages:$missing"
if [ "$(id -u)" = 0 ]; then
  as_root=
elif command -v sudo >/dev/null && sudo -v; then
  as_root=sudo
else
  echo "They are missing, and this user may not install them. As root, type" >&2
  echo "    $line" >&2
  echo "and run make again." >&2
  exit 1
fi
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq && $as_root $line -y -qq >/tmp/malus-install.$$ 2>&1 || {
  tail -n 5 /tmp/malus-install.$$ >&2
  echo "The installation failed; the whole log is /tmp/malus-install.$$" >&2
  exit 1
}
rm -f /tmp/malus-install.$$
echo "Installed."
