# SPDX-License-Identifier: BSD-3-Clause
"""Damaged result files through the real program: it says what is wrong, and soon.

usage: damaged_results.py MONTECARTA [COUNT [FIRST]]      (default: 200 damaged files, from seed 0)

Each file is a small result with bytes changed, eight bytes set to an extreme number, or its end cut
off: where HDF5 keeps its structures, anywhere, or in what is stored of runs; or its objects are
removed, renamed, retyped and filled with other numbers (where h5py is installed). Four of ten go
through `analyze`, two through `gate`, the others through the other commands that open a result.
Allowed are the exit codes 0 and 2 (4, "a run differs", of verify and replay; 4 and 5 of gate)
within 5 s of processor time and 2 GB. The verdict must be that of the whole file unless the damage
is said. A file that breaks this is kept, and named.
"""
import collections
import functools
import itertools
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

try:
    import h5py
    import numpy
except ImportError:  # the other kinds of damage need no library
    h5py = None

SECONDS = 5.0  # of processor time; several programs at once may take longer by the clock
PATIENCE = 60.0  # [s] by the clock
MEMORY = 2 << 30  # [bytes]

STUDY = """[study]
name = blink
runs = 4
[scenario]
world = blink.csv
noise = matched
control_rate = 10
scan_rate = 5
[record]
columns = covariance, ancestry, particles, association, map, final_map, joint
[cells]
cell = ekf_slam
cell = fastslam2 particles=8
"""
WORLD = "kind,x,y\nwaypoint,10,0\nwaypoint,20,1\nlandmark,15,5\nlandmark,25,-4\n"

WORDS = (0, 1, 2**64 - 1, 2**63 - 1, 2**32 - 1, 2**31, 2**63)
NUMBERS = (float("nan"), float("inf"), -float("inf"), 1.7e308, -1.7e308, 5e-324, -1.0, 1e9, 1e150)
EXTREMES = ([struct.pack("<Q", word) for word in WORDS]
            + [struct.pack("<d", number) for number in NUMBERS])
STRUCTURES = re.compile(b"OHDR|OCHK|BTHD|BTLF|BTIN|FRHP|FHDB|FHIB|GCOL|HEAP|TREE|SNOD|MCSEAL")


def structures_in(good):
    """Where HDF5 and the seal keep their own, and the superblock."""
    return [0] + [found.start() for found in STRUCTURES.finditer(good)]


def ranges_in(good):
    """[(offset, length)] that the seal leaves open (analysis/FORMAT.md): what is stored of runs."""
    end, = struct.unpack_from("<Q", good, 28)
    if good[end:end + 8] != b"\x89MCSEAL\n":
        return []
    count, = struct.unpack_from("<Q", good, end + 24)
    return [struct.unpack_from("<QQ", good, end + 32 + 16 * i) for i in range(count)]


def change_objects(path, dice):
    """Removes, renames, retypes or fills some objects of an HDF5 file, as another program might."""
    with h5py.File(path, "r+") as file:
        for _ in range(dice.randint(1, 3)):
            names = []
            file.visit(names.append)
            name = dice.choice(names)
            thing, kind = file[name], dice.randrange(6)
            if kind == 0:
                del file[name]
            elif kind == 1:
                file.move(name, name + "_")
            elif kind == 2 and len(thing.attrs):
                key = dice.choice(list(thing.attrs))
                thing.attrs[key] = dice.choice(("", "x\ny", 10**30 * 1.0, -1, numpy.zeros((2, 3))))
            elif kind == 3 and isinstance(thing, h5py.Dataset):
                other = numpy.zeros(dice.choice(((), (0,), (3,), (2, 2), tuple(thing.shape))),
                                    dice.choice(("f4", "i1", "u8", "S5")))
                del file[name]
                file[name] = other
            elif isinstance(thing, h5py.Dataset) and thing.dtype.kind in "fiu" and thing.size:
                worst = dice.choice((float("nan"), float("inf"), -1e300, 0.0, 3.0))
                if thing.dtype.kind != "f":
                    worst = dice.choice((0, 1, numpy.iinfo(thing.dtype).max))
                flat = thing[...].reshape(-1)
                flat[dice.randrange(flat.size):] = worst
                thing[...] = flat.reshape(thing.shape)


def damaged(good, structures, ranges, seed, scratch):
    dice = random.Random(seed)
    data = bytearray(good)
    where = dice.choice(("structures", "anywhere", "runs", "runs", "objects"))
    if where == "objects":
        if h5py is None:
            where = "runs"
        else:
            scratch.write_bytes(good)
            try:
                change_objects(scratch, dice)
            except (OSError, RuntimeError, TypeError, ValueError, KeyError):
                pass  # what h5py itself refuses is damage enough
            return scratch.read_bytes()
    for _ in range(dice.randint(1, 3)):
        if where == "structures":
            at = dice.choice(structures) + dice.randrange(400)
        elif where == "runs" and ranges:
            begin, length = dice.choice(ranges)
            at = begin + (dice.randrange(length - 7) if length > 8 else 0)
            data[at] = dice.randrange(256)
            if length >= 8 and dice.random() < 0.7:
                data[at:at + 8] = dice.choice(EXTREMES)
            continue
        else:
            at = dice.randrange(len(data))
        at = min(at, len(data) - 8)
        kind = dice.random()
        if kind < 0.45:
            data[at] = dice.randrange(256)
        elif kind < 0.9:
            at -= at % 8 if dice.random() < 0.5 else 0
            data[at:at + 8] = dice.choice(EXTREMES)
        else:
            del data[dice.randrange(len(data) - 8):]
        if len(data) < 64:
            break
    return bytes(data)


CELLS = ("ekf_slam", "fastslam2_m8")


def verdict_in(command, said):
    """Of gate all that it says, of analyze the first table."""
    return said if command == "gate" else said.split(b"\n\n")[1]


class Ground:
    """A folder with the whole results that are damaged."""

    def __init__(self, folder, program):
        self.folder, self.program = Path(folder), program
        (self.folder / "blink.ini").write_text(STUDY)
        (self.folder / "blink.csv").write_text(WORLD)
        self.make("out.h5")
        self.make("scans.h5", "--set", "record.rate=scan")
        self.make("first.h5", "--runs", "0:2")
        self.make("last.h5", "--runs", "2:4")
        # Work in progress is the same file under another name.
        self.good = {name: (self.folder / name).read_bytes()
                     for name in ("out.h5", "scans.h5", "last.h5")}
        self.structures = {name: structures_in(data) for name, data in self.good.items()}
        self.ranges = {name: ranges_in(data) for name, data in self.good.items()}
        self.verdicts = {}
        for name in ("out.h5", "scans.h5"):
            for words in (["analyze", name], *(["gate", name, "--cell", cell] for cell in CELLS)):
                said = subprocess.run([program, *words], cwd=self.folder, capture_output=True)
                self.verdicts[name, words[0], words[-1]] = verdict_in(words[0], said.stdout)

    def make(self, name, *more):
        subprocess.run([self.program, "run", "blink.ini", "-o", name, "--quiet", *more],
                       cwd=self.folder, check=True, capture_output=True)


def command_of(seed, own):
    """(name, words, file to be damaged, name it has) of the case `seed` in its own folder."""
    out = str(own / "out.h5")
    others = [
        ("report", ["report", out, "-o", str(own / "report")]),
        ("compare", ["compare", out, "--baseline", "ekf_slam"]),
        ("verify", ["verify", out, "--sample", "2", "--seed", "1"]),
        ("replay", ["replay", out, "--cell", "fastslam2_m8", "--run", "1", "-o",
                    str(own / "replay.h5")]),
        ("merge", ["merge", str(own / "merged.h5"), "first.h5", str(own / "last.h5")]),
        ("run", ["run", "blink.ini", "-o", out, "--resume", "--quiet"]),
        ("status", ["status", "--each", "--whole", out]),
        ("info", ["info", out]),
    ]
    source = ("out.h5", "scans.h5")[seed % 2]
    if seed % 10 < 2:
        return "gate", ["gate", out, "--cell", CELLS[seed // 10 % 2]], source, "out.h5"
    if seed % 10 < 6:
        return "analyze", ["analyze", out, "--threads", "1"], source, "out.h5"
    name, words = others[seed // 10 * 4 % len(others) + seed % 10 - 6]
    source = "last.h5" if name == "merge" else "out.h5"
    return name, words, source, {"merge": "last.h5", "run": "out.h5.part"}.get(name, "out.h5")


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


@functools.cache
def runs_within_memory(program):
    """A program that was built with a sanitizer takes terabytes of addresses and cannot be held."""
    return subprocess.run([program, "--version"], capture_output=True,
                          preexec_fn=limit_memory).returncode == 0


def limit(program):
    resource.setrlimit(resource.RLIMIT_CPU, (int(SECONDS) + 1, int(SECONDS) + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if runs_within_memory(program):
        limit_memory()


def run(ground, words):
    """Exit code (negative: a signal), seconds of processor time, what was said."""
    runs_within_memory(ground.program)  # known before the process is started
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen([ground.program, *words], cwd=ground.folder, stdout=said,
                                   stderr=said, preexec_fn=lambda: limit(ground.program),
                                   start_new_session=True)
        end = time.monotonic() + PATIENCE
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                break
            if time.monotonic() > end:
                os.killpg(process.pid, signal.SIGKILL)
                pid, status, usage = os.wait4(process.pid, 0)
                break
            time.sleep(0.003)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return process.returncode, usage.ru_utime + usage.ru_stime, said.read()


def try_one(ground, seed):
    own = ground.folder / f"case{seed}"
    own.mkdir()
    name, words, source, place = command_of(seed, own)
    file = own / place
    file.write_bytes(damaged(ground.good[source], ground.structures[source],
                             ground.ranges[source], seed, own / "objects.h5"))
    code, seconds, said = run(ground, words)
    allowed = {"verify": (0, 2, 4), "replay": (0, 2, 4), "gate": (0, 2, 4, 5)}.get(name, (0, 2))
    key = source, name, words[-1] if name == "gate" else source
    verdict_changed = (code != 2 and key in ground.verdicts
                       and verdict_in(name, said) != ground.verdicts[key])
    # An error names the file; a merge may find fault with the other shard's equal runs.
    named = code in (0, 4, 5) or place.encode() in said or b"first.h5" in said
    internal = b"internal error" in said
    fault = None
    if code not in allowed or seconds > SECONDS or not named or internal or verdict_changed:
        kept = Path(tempfile.gettempdir()) / f"montecarta_damaged_{seed}_{place}"
        file.exists() and shutil.copy(file, kept)
        why = "another verdict" if verdict_changed else f"code {code}, {seconds:.1f} s"
        fault = f"{name}, seed {seed}: {why}, {kept}\n    {said[-300:]!r}"
    shutil.rmtree(own)
    return name, code, seconds, fault


def main():
    program = str(Path(sys.argv[1]).resolve())
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    counts, slowest, faults = collections.Counter(), collections.Counter(), []
    with tempfile.TemporaryDirectory(prefix="montecarta-damaged-") as folder:
        ground = Ground(folder, program)
        with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
            outcomes = pool.map(try_one, itertools.repeat(ground), range(first, first + count))
            for name, code, seconds, fault in outcomes:
                counts[name, code] += 1
                slowest[name] = max(slowest[name], seconds)
                if fault:
                    faults.append(fault)
                    print(fault, flush=True)
    for (name, code), number in sorted(counts.items()):
        print(f"{name:8} code {code:3}: {number:6}, slowest {slowest[name]:.2f} s")
    print(f"{count} damaged files, {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
