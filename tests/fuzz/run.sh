#!/bin/sh
# run.sh BUILD SECONDS: each door's fuzzer in its turn, with the project's own files as its first inputs.
# Ends with 1 if one of them found something; what it found lies in BUILD/found.
set -e
build=$1
each=$(($2 / 6))
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$build/found"
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# the first byte of a table says what it is taken for (table.cpp)
seed() { # DOOR BYTE FILE..
  door=$1 byte=$2
  shift 2
  mkdir -p "$build/corpus/$door"
  for file; do
    { printf "%s" "$byte"; cat "$file"; } >"$build/corpus/$door/$(basename "$file")-${byte:-0}"
  done
}
for file in "$root"/scenes/*.json; do
  case $file in *parking-lot*) ;; *) seed scene "" "$file" ;; esac # its meshes are large, and made by a script
done
seed mesh "" "$root"/scenes/*.obj
seed table P "$root"/validation/printed/T3.*.csv
seed table Q "$root"/scenes/data/grass.csv
seed table R "$root"/scenes/data/copper.csv
seed table S "$root"/scenes/data/*.yml
seed table T "$root"/tests/fuzz/sky.csv
seed table G "$root"/tests/fuzz/greek.csv

# small letters begin with a valid file of the kind (measured.cpp); former findings are in corpus/
for kind in k c m e; do mkdir -p "$build/corpus/measured"; printf "%s0123456789" "$kind" >"$build/corpus/measured/$kind"; done
for door in scene scenes mesh table measured cube; do
  mkdir -p "$build/corpus/$door"
  cp "$root/tests/fuzz/corpus/$door/"* "$build/corpus/$door/"
done

status=0
for door in scene scenes mesh table measured cube; do
  echo "== $door: $each s"
  "$build/fuzz_$door" -max_total_time="$each" -timeout=20 -rss_limit_mb=4096 -max_len=40000 -print_final_stats=1 \
    -dict="$root/tests/fuzz/words.dict" -artifact_prefix="$build/found/$door-" "$build/corpus/$door" \
    >"$build/found/$door.log" 2>&1 || status=1
  grep -E '^(stat::number_of_executed_units|SUMMARY|==.*ERROR|not one line|a pixel)' "$build/found/$door.log" || true
done
[ $status = 0 ] && echo "nothing found" || echo "see $build/found"
exit $status
