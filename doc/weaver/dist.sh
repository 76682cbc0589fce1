#!/bin/sh
# dist.sh OUT CHAPTER:ROOT,ROOT...: a source archive of the committed HEAD with the tangled C++ inside,
# for machines without noweb: cmake -B build -DMALUS_PLAIN=ON && cmake --build build
set -eu
out=$1
shift
name=$(basename "$out" .tar.gz)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git archive --format=tar --prefix="$name/" HEAD | tar -x -C "$work"
for entry in "$@"; do
  chapter=${entry%%:*}
  roots=$(echo "${entry#*:}" | tr ',' ' ')
  # shellcheck disable=SC2086
  (cd "$work/$name" && doc/weaver/tangle.py --plain generated/malus "$chapter" $roots)
done
mkdir -p "$(dirname "$out")"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -czf "$out" "$name"
echo "The archive: $out"
