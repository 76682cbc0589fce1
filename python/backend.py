#!/usr/bin/python3
"""The module malus as a wheel, and the source archive that pip builds one from (PEP 517; pyproject.toml names this file).

    backend.py ROOT DIRECTORY

packs into DIRECTORY what is installed below ROOT. The wheel holds the module, its data, the libraries of malus for both
instruction sets, and those libraries of Debian that a bare system lacks, with their licences. The same tree gives the same bytes.
"""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
import tomllib

TOP = pathlib.Path(__file__).resolve().parent.parent
# what every Linux with a compiler's runtime has; all else that our libraries need goes with them
SYSTEM = ("libc.so", "libm.so", "libgcc_s.so", "libstdc++.so", "ld-linux", "libmalus")
DATA = ("scenes", "validation")


def said(*words: str) -> str:
    """The output of a command."""
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def version() -> str:
    """The project's version, from CMakeLists.txt."""
    found = re.search(r"^project\(malus VERSION (\S+)", (TOP / "CMakeLists.txt").read_text(encoding="utf-8"), re.M)
    assert found
    return found[1]


def metadata() -> str:
    """The core metadata, from pyproject.toml."""
    project = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version()}", f"Summary: {project['description']}",
             "License: MIT", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {name}; extra == "{extra}"' for name in names)]
    return "\n".join(lines) + "\n"


def tag() -> str:
    """For which Python, with which binary interface, on which system."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def needed(library: pathlib.Path) -> list[str]:
    """The libraries that this one names, but not where they are."""
    names: list[str] = re.findall(r"\(NEEDED\).*\[(.*)\]", said("readelf", "-dW", str(library)))
    return [name for name in names if not name.startswith(SYSTEM)]


def from_debian(libraries: list[pathlib.Path]) -> tuple[dict[str, pathlib.Path], dict[str, pathlib.Path]]:
    """Debian's libraries below these, by name, and the licences of their packages."""
    cache = dict(re.findall(r"^\s*(\S+) \(.*=> (.*)$", said("/sbin/ldconfig", "-p"), re.M)[::-1])  # the first of a name counts
    found: dict[str, pathlib.Path] = {}
    names = [name for library in libraries for name in needed(library)]
    while names:
        name = names.pop()
        if name not in found:
            found[name] = pathlib.Path(cache[name]).resolve()
            names += needed(found[name])
    licences = {}
    for path in found.values():
        owner = said("dpkg-query", "-S", f"*/{path.name}").split(":")[0]
        licences[owner] = pathlib.Path("/usr/share/doc") / owner / "copyright"
    return found, licences


def content(root: pathlib.Path) -> dict[str, pathlib.Path]:
    """The files of the wheel, by their names there, from a tree of make install."""
    module = next(root.rglob("malus/_malus*.so"))
    library = next(path for path in root.rglob("libmalus.so.0") if "glibc-hwcaps" not in path.parts).parent
    share = root.joinpath(*library.relative_to(root).parts[:-1], "share", "malus")
    files = {f"malus/{path.name}": path for path in module.parent.iterdir() if path.is_file()}
    plugins = ("libmalus_netcdf.so", "libmalus_images.so", "libmalus_meshes.so", "libmalus_terrain.so")
    ours = [path for name in ("libmalus.so.0", "libmalus_scenes.so.0", *plugins) for path in library.rglob(name)]
    files.update({f"malus/lib/{path.relative_to(library)}": path for path in ours})
    # the writer of netCDF needs HDF5 and its compressors, the reader of images OpenImageIO; each is loaded only where these are installed
    debian, licences = from_debian([module, *(path for path in ours if path.name not in plugins)])
    files.update({f"malus/lib/malus/{name}": path for name, path in debian.items()})
    for folder in DATA:
        files.update({f"malus/share/malus/{path.relative_to(share)}": path for path in (share / folder).rglob("*") if path.is_file()})
    files.update({f"malus-{version()}.dist-info/licenses/{name}": path for name, path in licences.items()})
    files[f"malus-{version()}.dist-info/licenses/malus"] = TOP / "LICENSE"
    return files


def pack(root: pathlib.Path, directory: pathlib.Path) -> str:
    """The name of the wheel that is now in the directory."""
    information = f"malus-{version()}.dist-info"
    texts = {f"{information}/METADATA": metadata(),
             f"{information}/WHEEL": f"Wheel-Version: 1.0\nGenerator: malus\nRoot-Is-Purelib: false\nTag: {tag()}\n"}
    parts = {name: path.read_bytes() for name, path in content(root).items()}
    parts.update({name: text.encode() for name, text in texts.items()})
    record = ""
    for name, data in sorted(parts.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    parts[f"{information}/RECORD"] = f"{record}{information}/RECORD,,\n".encode()
    name = f"malus-{version()}-{tag()}.whl"
    directory.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(directory / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        # a zip's clock begins in 1980; we use that moment. RECORD comes last, as the format advises
        for part in sorted(parts, key=lambda part: (part.endswith("/RECORD"), part)):
            entry = zipfile.ZipInfo(part)
            entry.external_attr = 0o100644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, parts[part])
    return name


def build_wheel(wheel_directory: str, config_settings: object = None, metadata_directory: object = None) -> str:
    """PEP 517's, for pip: build and install into a folder aside, and pack that."""
    del config_settings, metadata_directory
    with tempfile.TemporaryDirectory() as root:
        subprocess.run(["make", "-C", str(TOP), "NEED=true", "install", "PREFIX=/usr", f"DESTDIR={root}"], check=True)
        return pack(pathlib.Path(root), pathlib.Path(wheel_directory))


def build_sdist(sdist_directory: str, config_settings: object = None) -> str:
    """PEP 517's: the source archive that make dist writes, without the site."""
    del config_settings
    subprocess.run(["make", "-C", str(TOP), "NEED=true", "SITE=no", "dist"], check=True)
    name = f"malus-{version()}.tar.gz"
    shutil.copy(TOP / "dist" / name, os.path.join(sdist_directory, name))
    return name


if __name__ == "__main__":
    print(pathlib.Path(sys.argv[2]) / pack(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
