#!/bin/sh
# wheel.sh WHEEL README: the wheel in a fresh environment of Python, with NumPy, xarray and matplotlib of the system, draws the README's sky.
set -eu
wheel=$(realpath "$1") readme=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export MPLBACKEND=Agg HOME="$work" PYTHONDONTWRITEBYTECODE=1
unset PYTHONPATH PYTHONHOME
/usr/bin/python3 -m venv --system-site-packages venv
venv/bin/pip install -q --no-index --no-deps --disable-pip-version-check "$wheel"
sed -n '/^    import malus$/,/savefig/s/^    //p' "$readme" >lines.py
grep -q savefig lines.py
venv/bin/python lines.py
test -s polarized_sky.png
# the libraries and the data are the wheel's own; pictures of a scene are rendered as well
venv/bin/python - <<'PYTHON'
import pathlib
import malus
home = pathlib.Path(malus.__file__).parent
assert home.is_relative_to(pathlib.Path("venv").resolve()), home
assert malus.render(home / "share/malus/scenes/flat-plate.json", tile=(0, 0, 8, 8)).sizes["x"] == 8
mapped = {line.split()[-1] for line in open("/proc/self/maps", encoding="ascii") if ".so" in line}
for name in ("libmalus.so", "libmalus_scenes.so", "libembree3.so", "libtbb.so", "libnova", "libyaml-cpp.so", "libfmt.so"):
    found = [path for path in mapped if name in path]
    assert found and all(path.startswith(str(home)) for path in found), (name, found)
PYTHON
# the controls: what is damaged is not installed; what was taken away again is not found
cp "$wheel" damaged-0-py3-none-any.whl
printf x >>damaged-0-py3-none-any.whl
truncate -s -9000 damaged-0-py3-none-any.whl
! venv/bin/pip install -q --no-index --no-deps --disable-pip-version-check ./damaged-0-py3-none-any.whl 2>/dev/null
venv/bin/pip uninstall -q -y malus
test ! -e venv/lib/python3*/site-packages/malus
echo "wheel: the sky is drawn"
