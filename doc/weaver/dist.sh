#!/bin/sh
# dist.sh OUT CHAPTER:ROOT,ROOT...: a source archive of the committed HEAD with the tangled C++ inside,
# for machines without noweb: cmake -B build && cmake --build build. It is what pip calls an sdist, with PKG-INFO.
# With SITE set to a build that has woven the book, the archive has the site of make site, but for packages, as site/: reading needs no compiler.
# The same commit gives the same bytes: no clock, names in order.
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
PYTHONPATH=python /usr/bin/python3 -B -c 'import backend; print(backend.metadata(), end="")' >"$work/$name/PKG-INFO"
[ -z "${SITE:-}" ] || doc/weaver/collect.py --out "$work/$name/site" --book "$SITE/book" --report "$SITE/report" --paper "$SITE/malus-1.pdf" "$SITE/malus-2.pdf"
mkdir -p "$(dirname "$out")"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mode=go=rX --mtime="@$(git log -1 --format=%ct)" --use-compress-program='gzip -n' -cf "$out" "$name"
echo "The archive: $out"
