#!/bin/sh
# clean-run.sh NAME: record in validation/clean-runs.csv that this commit passed NAME (sanitize, tsan).
# Only a work tree without changes is a commit; otherwise it says so and records nothing.
set -eu
cd "$(dirname "$0")/.."
record=validation/clean-runs.csv
if [ -n "$(git status --porcelain --untracked-files=no -- . ":!$record")" ]; then
  echo "The tree has uncommitted changes: the clean run of $1 is not recorded."
  exit 0
fi
line="$1,$(date -u +%Y-%m-%d),$(git rev-parse --short=12 HEAD)"
{ grep -v "^$1," "$record"; echo "$line"; } >"$record.new"
mv "$record.new" "$record"
echo "recorded in $record: $line"
