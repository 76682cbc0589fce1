#!/usr/bin/python3
"""The recipes of examples/cluster on a real Slurm of this machine alone, and Open MPI: cluster.py MALUS SOURCE RECORD (as root).

munged, slurmctld and three slurmds run in a separate directory under /tmp, bound to the loopback, and are ended at the
end. A film is rendered by one process; by array jobs, undisturbed, with one task killed, and with one node's files
lost; by mpirun with several numbers of ranks, with one of them killed (rank 0, too), and with ranks that have no scene; and by an MPI
job of Slurm. Each time the bytes of all files but the record are compared. The last line says whether all are equal.
"""
import filecmp
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any, Callable

PARTS, NODES, PATIENCE_S, TIMES = 8, 3, 240, 3
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe"]
SLURM = """ClusterName=malus
SlurmctldHost={host}(127.0.0.1)
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthInfo=socket={home}/munge.sock
SlurmUser=root
SlurmdUser=root
SlurmctldPort={port}
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool-%n
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd-%n.pid
SlurmctldLogFile={home}/slurmctld.log
SlurmdLogFile={home}/slurmd-%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MailProg=/bin/true
{nodes}
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def free_port() -> int:
    """A free port of the loopback."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Cluster:
    """A Slurm with several nodes on this machine; ends what it has started."""

    def __init__(self, home: Path) -> None:
        self.home = home
        self.daemons: list[subprocess.Popen[bytes]] = []
        nodes = "\n".join(f"NodeName=node{i} NodeHostname={socket.gethostname()} NodeAddr=127.0.0.1 "
                          f"Port={free_port()} CPUs=1 State=UNKNOWN" for i in range(1, NODES + 1))
        conf = home / "slurm.conf"
        conf.write_text(SLURM.format(host=socket.gethostname(), home=home, port=free_port(), nodes=nodes), encoding="utf-8")
        self.environment = os.environ | {"SLURM_CONF": str(conf)}

    def start(self, *command: str) -> None:
        """A daemon in the foreground."""
        with open(self.home / f"{Path(command[0]).name}.out", "ab") as log:
            self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))

    def __enter__(self) -> "Cluster":
        (self.home / "munge.key").write_bytes(os.urandom(128))
        (self.home / "munge.key").chmod(0o400)
        (self.home / "state").mkdir()
        self.start("munged", "--foreground", "--force", f"--key-file={self.home}/munge.key", f"--socket={self.home}/munge.sock",
                   f"--pid-file={self.home}/munged.pid", f"--log-file={self.home}/munged.log", f"--seed-file={self.home}/munged.seed")
        wait_for((self.home / "munge.sock").exists, "munged does not start")
        self.start("slurmctld", "-D")
        for i in range(1, NODES + 1):
            self.start("slurmd", "-D", "-N", f"node{i}")
        wait_for(lambda: self.run("sinfo", "-h", "-t", "idle", "-o", "%D").strip() == str(NODES), "the nodes do not come up")
        return self

    def __exit__(self, *_: object) -> None:
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()

    def run(self, *command: str, **more: str) -> str:
        """The output of a command of Slurm; it may fail while the daemons start."""
        return subprocess.run(command, env=self.environment | more, cwd=self.home, text=True, check=False, timeout=PATIENCE_S,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout

    def array(self, recipe: Path, tasks: str, *arguments: str) -> str:
        """Submits an array job; returns its number."""
        return self.run("sbatch", "--parsable", f"--array={tasks}", str(recipe), *arguments, PARTS=str(PARTS)).strip()

    def finish(self, job: str) -> None:
        """Waits for the end of a job."""
        wait_for(lambda: not self.run("squeue", "-h", "-j", job, "-o", "%i").strip(), f"job {job} does not end")


def wait_for(true: object, complaint: str) -> None:
    """Looks twenty times a second until it is true, but not for ever."""
    end = time.monotonic() + PATIENCE_S
    while not true():  # type: ignore[operator]
        if time.monotonic() > end:
            sys.exit(complaint)
        time.sleep(0.05)


def differing(whole: Path, merged: Path) -> list[str]:
    """Names of the files of a single run that a merge has not made to the same bytes."""
    names = [path.name for path in whole.iterdir() if not path.name.endswith(".run.json")]
    return sorted(name for name in names
                  if not (merged / name).exists() or not filecmp.cmp(whole / name, merged / name, shallow=False))


def has_lines(file: Path, lines: int) -> bool:
    return file.exists() and file.read_bytes().count(b"\n") > lines


def ranks_alone(home: Path, enter: Callable[[str, str, int], None], tiles: int) -> None:
    """mpirun without Slurm: several numbers of ranks; one killed, then the first; ranks in a directory without the scene; no plug-in."""

    def run(*command: str, where: Path = home, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*MPIRUN, *command], cwd=where, env=os.environ | more, text=True, check=False, capture_output=True,
                              timeout=PATIENCE_S)

    for ranks in (1, 2, 3, 8):
        done = run("-n", str(ranks), "malus", "render", "film.json", "--out", f"ranks-{ranks}", "--threads", "1")
        if done.returncode != 0 or done.stdout.count("\n") != 1:
            sys.exit(f"{ranks} ranks: {done.stderr}")
        enter(f"mpirun, {ranks} ranks", f"ranks-{ranks}", 0)

    for victim, words in ((2, "continues from here"), (0, "continue with")):  # rank 0 has reported it before it dies
        out = f"died-{victim}"
        with subprocess.Popen([*MPIRUN, "-n", "3", "malus", "render", "film.json", "--out", out, "--threads", "1"], cwd=home,
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            journal = home / out / "film.0001.truth.img.tiles"
            wait_for(partial(has_lines, journal, tiles // 3), "the ranks do not begin")
            children = (pid.name for pid in Path("/proc").iterdir() if pid.name.isdigit())
            os.kill(int(next(pid for pid in children if rank_of(pid, running.pid) == victim)), signal.SIGKILL)
            complaint = running.communicate(timeout=PATIENCE_S)[1]
        line = next((line for line in complaint.splitlines() if line.endswith(words)), "")
        if running.returncode == 0 or f"malus render film.json --out {out} --resume" not in line:
            sys.exit(f"rank {victim} was killed, and how to go on was not said: {complaint}")
        kept = journal.read_bytes().count(b"\n") - 1
        done = run("-n", "2", "malus", "render", "film.json", "--out", out, "--resume")
        if done.returncode != 0 or f"frame 2 of 3: {tiles - kept} of {tiles} tiles" not in done.stderr:
            sys.exit(f"{kept} tiles were kept: {done.stderr}")
        print(line)
        enter(f"rank {victim} of 3 killed", out, tiles - kept)

    (home / "elsewhere").mkdir()
    first = ["-n", "1", "--wdir", str(home), "malus", "render", "film.json", "--out", str(home / "sent")]
    others = ["-n", "2", "--wdir", str(home / "elsewhere"), *first[4:]]
    done = run(*first, ":", *others)
    if done.returncode != 0:
        sys.exit(f"ranks without a scene: {done.stderr}")
    enter("2 of 3 ranks have no files", "sent", 0)

    for what, arguments, words in (
            ("a part", ["--part", "1/2"], "--part = 1/2: is for independent processes"),
            ("no scene", ["--seed", "x"], "--seed = x: does not consist of whole numbers")):
        done = run("-n", "2", "malus", "render", "film.json", "--out", "none", *arguments)
        if done.returncode != 2 or done.stderr.count(words) != 1 or (home / "none").exists():
            sys.exit(f"{what}: {done.stderr}")


def scaling(home: Path, scene: dict[str, Any], record: Path) -> None:
    """Writes the processor time of so many ranks for cheap tiles, which other work on the machine changes little, and
    the time on the clock for expensive ones: the machine must be idle."""
    small = scene | {"geometry": scene["geometry"][1:], "sensor": scene["sensor"] | {"width": 1024, "height": 1024},
                     "radiometry": {"sampling": "grid-rotated", "rays": [1], "seed": 1},
                     "platform": scene["platform"] | {"frames": 1}}
    (home / "small.json").write_text(json.dumps(small), encoding="utf-8")
    tiles = (1024 // 16) ** 2

    def once_s(ranks: int, scene_file: str, *more: str) -> tuple[float, float]:
        before = os.times()
        command = ["malus", "render", scene_file, "--out", f"cost-{ranks}", "--write", "cube,truth", *more]
        if "--threads" not in more:  # unbound: Open MPI would bind each of two ranks to a core, rank 0 with both of its threads
            command = [*MPIRUN, "--bind-to", "none", "-n", str(ranks), *command, "--threads", "1"]
        subprocess.run(command, cwd=home, check=True, capture_output=True, timeout=PATIENCE_S)
        after = os.times()
        return (after.children_user + after.children_system - before.children_user - before.children_system,
                after.elapsed - before.elapsed)

    def least_s(ranks: int, scene_file: str, *more: str, clock: bool = False) -> float:
        return min(once_s(ranks, scene_file, *more)[clock] for _ in range(TIMES))

    def dear_s(ranks: int, *more: str) -> float:
        return least_s(ranks, "dear.json", *more, clock=True) - least_s(ranks, "dear.json", *more, *one_tile, clock=True)

    one_tile = ("--part", "0,0,16,16")
    film = (least_s(1, "film.json", "--frames", "0") - least_s(1, "film.json", "--frames", "0", *one_tile)) / 255
    dear = small | {"geometry": scene["geometry"], "sensor": scene["sensor"],
                    "radiometry": {"sampling": "importance", "rays": [2500], "seed": 1}}
    (home / "dear.json").write_text(json.dumps(dear), encoding="utf-8")
    lines = [f"# title: Processor time of ranks for a picture of {tiles} cheap tiles, "
             "and their time on the clock for 256 expensive ones, without their start",
             f"# source: make cluster-test on an idle machine of {os.cpu_count()} processors, the least of {TIMES} runs each",
             f"# date: {time.strftime('%Y-%m-%d', time.gmtime())}",
             "ranks,processors,tiles,work_s,film_tile_s,dear_clock_s,dear_threads_s"]
    for ranks in (1, 2, 3, 8):
        work = least_s(ranks, "small.json") - least_s(ranks, "small.json", *one_tile)
        lines.append(f"{ranks},{os.cpu_count()},{tiles},{work:.3f},{film:.6f},{dear_s(ranks):.2f},{dear_s(ranks, '--threads', str(ranks)):.2f}")
    record.write_text("\n".join(lines) + "\n", encoding="utf-8")


def rank_of(pid: str, mpirun: int) -> int:
    """The rank of a malus that this mpirun has started; -1 of other processes."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
        words = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return -1
    if not status.startswith("Name:\tmalus\n") or f"\nPPid:\t{mpirun}\n" not in status:
        return -1
    return next((int(word[21:]) for word in words if word.startswith(b"OMPI_COMM_WORLD_RANK=")), -1)


def main() -> None:
    malus, source, record = (Path(word).resolve() for word in sys.argv[1:4])
    recipes, home = source / "examples/cluster", Path(tempfile.mkdtemp(prefix="malus-cluster-"))
    os.environ["PATH"] = f"{malus.parent}:{os.environ['PATH']}"
    scene = json.loads(re.sub(r"^\s*//.*", "", (source / "scenes/flight-nadir.json").read_text(encoding="utf-8"), flags=re.M))
    scene["geometry"][0]["obj"] = str(source / "scenes/chunky-bar.obj")
    scene["platform"]["frames"] = 3
    (home / "film.json").write_text(json.dumps(scene), encoding="utf-8")
    subprocess.run([malus, "render", "film.json", "--out", "whole"], cwd=home, check=True, capture_output=True, timeout=PATIENCE_S)
    files = len(list((home / "whole").iterdir()))
    tiles = json.loads((home / "whole/film.0001.run.json").read_text(encoding="utf-8"))
    tiles = -(-tiles["width"] // 16) * -(-tiles["height"] // 16)
    rows: list[tuple[str, str, int, int]] = []

    def merge(out: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([malus, "merge", out], cwd=home, text=True, check=False, capture_output=True, timeout=PATIENCE_S)

    def enter(what: str, out: str, remade: str) -> None:
        done = merge(out)
        if done.returncode != 0:
            sys.exit(f"{what}: {done.stderr}")
        rows.append((what, remade, files - 3, len(differing(home / "whole", home / out))))

    def compare(what: str, out: str, remade: int) -> None:
        rows.append((what, f"{remade} tiles" if remade else "none", files - 3, len(differing(home / "whole", home / out))))

    def mend(cluster: Cluster, out: str, complaint: str) -> str:
        """Makes the parts that a refused merge names, by the recipe; returns their list."""
        found = re.search(rf"part ([\d,-]+) of {PARTS} does not exist", complaint)
        if not found:
            sys.exit(f"no missing part is named: {complaint}")
        print(complaint.strip())
        cluster.finish(cluster.array(recipes / "array.sbatch", found[1], "film.json", out))
        return found[1]

    try:
        ranks_alone(home, compare, tiles)
        scaling(home, scene, record)
        with Cluster(home) as cluster:
            # (on one of the nodes: Slurm's PMIx has one folder a machine, and these nodes are one)
            job = cluster.run("sbatch", "--parsable", "--nodes=1", "--overcommit", f"--ntasks={NODES}", str(recipes / "mpi.sbatch"),
                              "film.json", "job").strip()
            cluster.finish(job)
            log = (home / f"malus-mpi-{job}.log").read_text(encoding="utf-8")
            if f"{NODES} ranks on" not in log or '"state":"done","frames":3' not in log:
                sys.exit(f"the MPI job: {log}")
            compare(f"MPI job of Slurm, {NODES} ranks", "job", 0)
            undisturbed = cluster.array(recipes / "array.sbatch", f"1-{PARTS}", "film.json", "all")
            cluster.finish(undisturbed)
            enter(f"array of {PARTS} on {NODES} nodes", "all", "none")

            job = cluster.array(recipes / "array.sbatch", f"1-{PARTS}", "film.json", "killed")
            journal = home / f"killed/film.0001.part-4-of-{PARTS}.truth.img.tiles"
            wait_for(lambda: journal.exists() and journal.read_bytes().count(b"\n") > 3, "part 4 does not begin")
            cluster.run("scancel", "--full", "--signal=KILL", f"{job}_4")
            cluster.finish(job)
            refused = merge("killed")
            if refused.returncode != 2:
                sys.exit("part 4 ended before it could be killed")
            enter("one task killed", "killed", mend(cluster, "killed", refused.stderr))

            shutil.copytree(home / "all", home / "lost")
            for path in (home / "lost").iterdir():  # no file of the merge is left to help
                if ".part-" not in path.name:
                    path.unlink()
            logs = [path.read_text(encoding="utf-8") for path in home.glob(f"malus-{undisturbed}-*.log")]
            on_node = {found[1] for log in logs if (found := re.match(r"part (\d+) of \d+ on node2", log))}
            for part in on_node:
                for path in (home / "lost").glob(f"*.part-{part}-of-{PARTS}.*"):
                    path.unlink()
            refused = merge("lost")
            if refused.returncode != 2 or not on_node:
                sys.exit("node2 had no files to lose")
            enter("the files of node2 lost", "lost", mend(cluster, "lost", refused.stderr))
        # a comparison that could not fail would prove nothing
        subprocess.run([malus, "render", "film.json", "--out", "other", "--seed", "2"], cwd=home, check=True, capture_output=True,
                       timeout=PATIENCE_S)
        control = len(differing(home / "whole", home / "other"))
    finally:
        if len(rows) == 11:
            shutil.rmtree(home)
        else:
            print(f"The logs are in {home}", file=sys.stderr)
    print(f"\n{'':28}{'made again':>18}{'files':>7}{'differ':>8}")
    for what, remade, compared, differ in rows:
        print(f"{what:28}{remade:>18}{compared:>7}{differ:>8}")
    print(f"{'another seed (control)':28}{'':>18}{files - 3:>7}{control:>8}")
    sys.exit(any(row[3] for row in rows) or control == 0)


if __name__ == "__main__":
    main()
