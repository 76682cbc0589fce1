#!/usr/bin/python3
"""Kill, resume, fill the disk, race writers, and compare bits: soak.py PROGRAM [SECONDS] [SEED].

A reference picture is rendered once, undisturbed. Then, until the time is over, one of several mishaps is chosen at random, happens to
a render of the same scene, and the run is resumed to its end. Every cube must have the bits of the reference, every refusal must be
one line with exit code 2, and nothing half written may bear a true name. Exit code 1 at the first failure, with the seed that repeats it.
"""
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable

program = os.path.abspath(sys.argv[1])
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 600
seed = int(sys.argv[3]) if len(sys.argv) > 3 else int(time.time())
dice = random.Random(seed)
scenes = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scenes")
CUBES = ["s.0000.img", "s.0000.truth.img", "s.0001.img", "s.0001.truth.img"]


def text_of(path: str) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


def put(path: str, text: str) -> None:
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Failure(Exception):
    pass


def demand(good: object, what: str) -> None:
    if not good:
        raise Failure(what)


def start(place: str, *flags: str, limit: int | None = None, streams: int | None = None) -> "subprocess.Popen[str]":
    def before() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    out = streams or subprocess.PIPE
    return subprocess.Popen([program, "render", "s.json", *flags], cwd=place, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=out, preexec_fn=before, text=True)


def run(place: str, *flags: str, limit: int | None = None) -> tuple[int, str, str]:
    process = start(place, *flags, limit=limit)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err or ""


def refused(place: str, *flags: str, limit: int | None = None) -> str:
    code, _, err = run(place, *flags, limit=limit)
    demand(code == 2 and err.count("\n") == 1, f"{flags}: exit {code}, {err!r}")
    return err


def cubes(directory: str) -> dict[str, bytes]:
    return {name: open(os.path.join(directory, name), "rb").read() for name in CUBES}


def whole_files_only(place: str, directory: str) -> None:
    """Whatever bears a true name is whole: a cube of the reference's bits, a record that can be read."""
    if not os.path.isdir(os.path.join(place, directory)):
        return
    for name in os.listdir(os.path.join(place, directory)):
        path = os.path.join(place, directory, name)
        if name in CUBES:
            demand(open(path, "rb").read() == reference[name], f"{name} bears its name and is not whole")
        if name.endswith(".run.json"):
            record = json.loads(text_of(path))
            for cube, checksum in record["cubes"].items():
                there = zlib.crc32(open(os.path.join(place, directory, cube), "rb").read())
                demand(f"{there:08x}" == checksum, f"{name} vouches for {cube} and is wrong")


def finish(place: str, *flags: str) -> None:
    """Resumes to the end, and compares."""
    code, _, err = run(place, "--out", "b", "--resume", *flags)
    demand(code == 0, f"the resumed run ended with {code}: {err}")
    demand(cubes(os.path.join(place, "b")) == reference, "other bits after resuming")
    rest = [n for n in os.listdir(os.path.join(place, "b")) if n.endswith((".part", ".tiles", ".new", ".lock")) or n[0] == "."]
    demand(not rest, f"left behind: {rest}")


def interrupt(place: str, number: int, *flags: str) -> None:
    process = start(place, "--out", "b", *flags, streams=subprocess.DEVNULL)
    time.sleep(dice.random() * 1.1 * duration)
    process.send_signal(number)
    process.communicate(timeout=300)
    demand(process.returncode in (0, -number, 128 + number), f"exit {process.returncode} after signal {number}")
    whole_files_only(place, "b")


def kills(place: str) -> None:
    for _ in range(dice.randint(1, 4)):
        interrupt(place, signal.SIGKILL, "--resume", "--threads", str(dice.randint(1, 3)))
    finish(place)


def stops(place: str) -> None:
    for _ in range(dice.randint(1, 3)):
        interrupt(place, dice.choice([signal.SIGINT, signal.SIGTERM]), "--resume")
    finish(place)


def races(place: str) -> None:
    """Many start at once into one directory; one of them works, and the others are refused."""
    many = [start(place, "--out", "b", *dice.choice(((), ("--resume",), ("--seed", "9"))), "--threads", "1")
            for _ in range(dice.randint(2, 5))]
    results = [p.communicate(timeout=300) + (p.returncode, p.args) for p in many]
    for _, err, code, args in results:
        demand(code == 0 or (code == 2 and err.count("\n") == 1), f"{args!r}: exit {code}, {err!r}")
    demand(any(code == 0 for _, _, code, _ in results), "nobody worked")
    for frame in ("0000", "0001"):
        record = json.loads(text_of(os.path.join(place, "b", f"s.{frame}.run.json")))
        for cube, checksum in record["cubes"].items():
            data = open(os.path.join(place, "b", cube), "rb").read()
            demand(f"{zlib.crc32(data):08x}" == checksum, f"{cube} differs from its record")
            if record["seed"] == 5:
                demand(data == reference[cube], f"{cube} has other bits after a race")


def frames_race(place: str) -> None:
    """Two frames by two programs at once do not conflict."""
    two = [start(place, "--out", "b", "--frames", frame, "--threads", "1") for frame in "01"]
    for process in two:
        _, err = process.communicate(timeout=300)
        demand(process.returncode == 0, err)
    finish(place)


def damage(place: str) -> None:
    run(place, "--out", "b")
    for name in dice.sample(CUBES, dice.randint(1, 3)):
        path = os.path.join(place, "b", name)
        size = os.path.getsize(path)
        how = dice.choice(["flip", "cut", "remove"])
        if how == "flip":
            with open(path, "r+b") as file:
                file.seek(dice.randrange(size))
                byte = file.read(1)[0]
                file.seek(-1, os.SEEK_CUR)
                file.write(bytes([byte ^ (1 << dice.randrange(8))]))
        elif how == "cut":
            os.truncate(path, dice.randrange(size))
        else:
            os.remove(path)
    finish(place)


def lose(place: str) -> None:
    """Kill, then damage what the resumed run reads first."""
    interrupt(place, signal.SIGKILL, "--resume")
    if os.path.isdir(os.path.join(place, "b")):
        for name in os.listdir(os.path.join(place, "b")):
            path = os.path.join(place, "b", name)
            if name.endswith((".part", ".tiles")) and dice.random() < .5:
                if dice.random() < .5:
                    os.remove(path)
                else:
                    os.truncate(path, dice.randrange(os.path.getsize(path) + 1))
    finish(place)


def mend(place: str) -> None:
    """Another mesh between two halves is refused, or nothing of the first half was there."""
    interrupt(place, signal.SIGKILL)
    mesh = os.path.join(place, "bar.obj")
    old = text_of(mesh)
    begun = os.path.isdir(os.path.join(place, "b")) and any(n.endswith(".tiles") and os.path.getsize(os.path.join(place, "b", n)) > 60
                                                            for n in os.listdir(os.path.join(place, "b")))
    record = os.path.join(place, "b", "s.0000.run.json.part")
    if os.path.exists(record) and dice.random() < .5:
        os.remove(record)
    if begun:
        put(mesh, "# mended\n" + old)
        refused(place, "--out", "b", "--resume")
        put(mesh, old)
    finish(place)


def full(place: str) -> None:
    """A limit on files, anywhere from nothing to all; with it the run is refused, and leaves no true name that is not whole."""
    largest = max(len(data) for data in reference.values())
    err = refused(place, "--out", "b", limit=dice.randrange(largest))
    demand("ulimit" in err or "cannot be written" in err, err)
    whole_files_only(place, "b")
    finish(place)


def disk(place: str) -> str | None:
    """A small disk in a file of memory, if the system allows mounting one in a separate namespace."""
    size = dice.randrange(20, 200) * 4096
    fill = f"(sleep {dice.random() * duration:.3f}; cat /dev/zero >b/fill) 2>/dev/null & " if dice.random() < .5 else ""
    if fill:
        size = 4 << 20
    script = (f"mount -t tmpfs -o size={size} none b || exit 99; {fill} '{program}' render s.json --out b; code=$?; "
              "wait; rm -f b/fill; cp -r b left; exit $code")
    os.mkdir(os.path.join(place, "b"))
    done = subprocess.run(["unshare", "-rm", "sh", "-c", script], cwd=place, capture_output=True, text=True)
    if "unshare" in done.stderr or done.returncode == 99:
        return "no tmpfs"
    demand(done.returncode in (0, 2) and (done.returncode == 0 or done.stderr.strip().split("\n")[-1].count(";")),
           f"exit {done.returncode}: {done.stderr}")
    whole_files_only(place, "left")
    finish(place)
    return None


def read_only(place: str) -> str | None:
    """A directory that is not writable is refused by the dry run as by the run, with the cause."""
    os.mkdir(os.path.join(place, "b"))
    script = f"mount -t tmpfs -o ro none b || exit 99; '{program}' render s.json --out b {dice.choice(['', '--dry-run', '--resume'])}"
    done = subprocess.run(["unshare", "-rm", "sh", "-c", script], cwd=place, capture_output=True, text=True)
    if "unshare" in done.stderr or done.returncode == 99:
        return "no tmpfs"
    demand(done.returncode == 2 and "Read-only file system; " in done.stderr, f"exit {done.returncode}: {done.stderr}")
    finish(place)
    return None


def closed(place: str) -> None:
    streams = dice.choice(["2>&-", ">&-", ">&- 2>&-", "2>/dev/full", "</dev/null >/dev/full 2>&-", "<&- >&- 2>&-"])
    done = subprocess.run(f"'{program}' render s.json --out b {streams}", shell=True, cwd=place, capture_output=True)
    demand(done.returncode in (0, 2), f"{streams}: exit {done.returncode}")
    demand(cubes(os.path.join(place, "b")) == reference, f"other bits with {streams}")


def parts(place: str) -> None:
    """Parts at once, one of them killed and resumed, then merged."""
    x = dice.randrange(1, 63)
    tiles = [f"0,0,{x},56", f"{x},0,64,56"]
    two = [start(place, "--out", "b", "--part", tile, "--threads", "1", streams=subprocess.DEVNULL) for tile in tiles]
    time.sleep(dice.random() * duration)
    two[0].kill()
    for process in two:
        process.communicate(timeout=300)
    demand(run(place, "--out", "b", "--part", tiles[0], "--resume")[0] == 0, "a part was not resumed")
    spoilt = dice.choice([None, "cut", "flip"])
    name = os.path.join(place, "b", f"s.0001.{tiles[1].replace(',', '-')}.truth.img")
    good = open(name, "rb").read()
    if spoilt:
        bad = bytearray(good[:-4] if spoilt == "cut" else good)
        bad[dice.randrange(len(bad))] ^= 1
        open(name, "wb").write(bad)
        before = sorted(os.listdir(os.path.join(place, "b")))
        done = subprocess.run([program, "merge", "b"], cwd=place, capture_output=True, text=True)
        demand(done.returncode == 2, f"merge of a spoilt part ended with {done.returncode}")
        # the frame before is whole, and merged; of the spoilt one there is nothing new
        new = set(os.listdir(os.path.join(place, "b"))) - set(before)
        demand(all(name.startswith("s.0000.") and not name.endswith((".part", ".tiles")) for name in new),
               f"merge refused and left {sorted(new)}")
        open(name, "wb").write(good)
    done = subprocess.run([program, "merge", "b"], cwd=place, capture_output=True, text=True)
    demand(done.returncode == 0, done.stderr)
    demand(cubes(os.path.join(place, "b")) == reference, "other bits after merging")
    finish(place)


def make_scene(place: str) -> None:
    text = text_of(os.path.join(scenes, "chunky-bar-copper.json"))
    scene = json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))
    shutil.copy(os.path.join(scenes, "chunky-bar.obj"), os.path.join(place, "bar.obj"))
    scene["geometry"][0]["obj"] = "bar.obj"
    scene["sensor"] = {"kind": "framing", "width": 64, "height": 56, "field_of_view_deg": 36.87}
    scene["radiometry"] = {"sampling": "importance", "rays": [24, 4], "seed": 5}
    scene["platform"]["frames"] = 2
    put(os.path.join(place, "s.json"), json.dumps(scene))


mishaps: list[Callable[[str], str | None]] = [kills, stops, races, frames_race, damage, lose, mend, full, disk, read_only, closed,
                                              parts]
begin = time.time()
counts = {mishap.__name__: 0 for mishap in mishaps}
with tempfile.TemporaryDirectory(prefix="malus-soak-") as home:
    base = os.path.join(home, "base")
    os.mkdir(base)
    make_scene(base)
    since = time.time()
    code, _, err = run(base, "--out", "b", "--threads", "1")
    duration = time.time() - since
    if code:
        sys.exit(f"the reference ended with {code}: {err}")
    reference = cubes(os.path.join(base, "b"))
    # the negative control: another seed is another picture, or the comparison below sees nothing
    run(base, "--out", "c", "--seed", "6")
    if cubes(os.path.join(base, "c")) == reference:
        sys.exit("two seeds give one picture: the soak cannot fail")
    rounds = 0
    while time.time() - begin < seconds:
        if rounds % len(mishaps) == 0:
            dice.shuffle(mishaps)  # each happens as often as the others
        mishap = mishaps[rounds % len(mishaps)]
        place = os.path.join(home, f"{rounds}")
        os.mkdir(place)
        make_scene(place)
        try:
            if mishap(place) is None:
                counts[mishap.__name__] += 1
        except Failure as failure:
            print(f"soak: seed {seed}, round {rounds}, {mishap.__name__}: {failure}")
            kept = tempfile.mkdtemp(prefix="malus-soak-kept-")
            shutil.copytree(place, kept, dirs_exist_ok=True)
            print(f"soak: the files are in {kept}")
            sys.exit(1)
        shutil.rmtree(place)
        rounds += 1
print(f"soak: {rounds} mishaps in {time.time() - begin:.0f} s, all bits the same (seed {seed}): "
      + ", ".join(f"{name} {count}" for name, count in counts.items()))
