#!/bin/sh
# twice.sh PROJECT [make's words...]: the committed HEAD of PROJECT, built in two directories, at two times, with two umasks, gives the same
# packages, wheel and source archive, byte for byte. Leaves the two trees where one can look at what differs.
set -eu
project=$1
shift
work=$(mktemp -d /var/tmp/malus-twice-XXXXXX)
first="$work/one" second="$work/another/place"
for tree in "$first" "$second"; do
  mkdir -p "$(dirname "$tree")"
  git clone -q "file://$project" "$tree"
  echo "make deb wheel dist in $tree"
  (cd "$tree" && TZ=$([ "$tree" = "$first" ] && echo UTC || echo Asia/Kathmandu) && export TZ &&
    umask "$([ "$tree" = "$first" ] && echo 022 || echo 027)" && make NEED=true deb wheel dist "$@") >"$work/log" 2>&1 ||
    { tail "$work/log"; exit 1; }
done
made() { (cd "$1" && ls build/deb/*.deb build/wheel/*.whl dist/*.tar.gz); }
[ "$(made "$first")" = "$(made "$second")" ] || { echo "the two trees make different files" >&2; exit 1; }
status=0
for name in $(made "$first"); do
  if cmp "$first/$name" "$second/$name"; then
    echo "the same $(stat -c %s "$first/$name") bytes: $name"
  else
    status=1
    ! command -v diffoscope >/dev/null || diffoscope "$first/$name" "$second/$name" | head -n 60
  fi
done
# the control: cmp notices one byte
name=$(made "$first" | head -n 1)
printf x | cat "$first/$name" - >"$work/longer"
! cmp -s "$work/longer" "$second/$name" || { echo "twice.sh compares nothing" >&2; exit 1; }
[ "$status" != 0 ] || rm -rf "$work"
exit "$status"
