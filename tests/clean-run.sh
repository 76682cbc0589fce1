#!/bin/sh
# clean-run.sh COMMAND BUILD BEGAN: record in validation/clean-runs.csv that this commit passed `COMMAND`, whose tests are
# those of BUILD and which began at BEGAN (seconds since 1970). One line a command, the last; a work tree with changes is
# no commit and is not recorded.
set -eu
cd "$(dirname "$0")/.."
record=validation/clean-runs.csv
if [ -n "$(git status --porcelain --untracked-files=no -- . ":!$record")" ]; then
  echo "The tree has uncommitted changes: the clean run of $1 is not recorded."
  exit 0
fi
tests=$(ctest --test-dir "$2" -LE book -N | sed -n 's/^Total Tests: //p')
line="$(date -u +%Y-%m-%d),$(git rev-parse --short=12 HEAD),$1,$tests,$(($(date +%s) - $3))"
{ grep -v ",$1,[0-9]*,[0-9]*$" "$record"; echo "$line"; } >"$record.new"
mv "$record.new" "$record"
echo "recorded in $record: $line"
