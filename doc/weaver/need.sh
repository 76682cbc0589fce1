#!/bin/sh
# need.sh PACKAGE...: see that these Debian packages are installed; install the missing ones.
# As root with apt-get; otherwise with sudo when it works; otherwise name the line to type and stop.
installed=" $(dpkg-query -W -f='${Package}=${db:Status-Status} ' "$@" 2>/dev/null)"
missing=
for package in "$@"; do
  case "$installed" in
    *" $package=installed "*) ;;
    *) missing="$missing $package" ;;
  esac
done
[ -z "$missing" ] && exit 0

if ! command -v apt-get >/dev/null; then
  echo "malus needs what Debian 12 calls:$missing" >&2
  echo "There is no apt-get here. Install them by your system's own means and run make NEED=true" >&2
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
echo "Installing them now (a few minutes the first time) ..."
log=$(mktemp)
export DEBIAN_FRONTEND=noninteractive
if $as_root apt-get update -qq >"$log" 2>&1 && $as_root $line -y -qq >>"$log" 2>&1; then
  echo "Installed."
  rm -f "$log"
else
  tail -n 5 "$log" >&2
  echo "The installation failed; its whole log is $log" >&2
  exit 1
fi
