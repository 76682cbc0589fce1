#!/bin/sh
# install.sh BUILD PREFIX DESTDIR BASELINE JOBS [-G GENERATOR]
# Installs what BUILD has. If BASELINE names an older instruction set than BUILD's, the libraries are compiled for it
# as well: those are the ones in lib/, and BUILD's go to lib/glibc-hwcaps, where newer processors find them.
set -eu
build=$1 prefix=$2 destdir=$3 baseline=$4 jobs=$5
shift 5
export DESTDIR="$destdir"
isa=$(sed -n 's/^MALUS_ISA:STRING=//p' "$build/CMakeCache.txt")
cmake --install "$build" --prefix "$prefix" >/dev/null
if [ -n "$baseline" ] && [ "$baseline" != "$isa" ] && [ "$(uname -m)" = x86_64 ]; then
  cmake --install "$build" --prefix "$prefix" --component faster >/dev/null
  cmake -S . -B "$build-$baseline" "$@" -DCMAKE_BUILD_TYPE=Release -DMALUS_ISA="$baseline" -DMALUS_BUILD_TESTS=OFF >/dev/null
  cmake --build "$build-$baseline" -j "$jobs" --target programs
  cmake --install "$build-$baseline" --prefix "$prefix" >/dev/null
fi
echo "malus is in $destdir$prefix"
