# SPDX-License-Identifier: BSD-3-Clause
"""Access to a folder of shards: its plan, the state of its files, and its tasks in the scheduler.

Shared by submit, status and cancel. Files determine the state: a shard has its final name only when
it is complete. The scheduler is only queried for tasks that have not ended.
"""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

HERE = Path(__file__).resolve().parent


class Problem(Exception):
    """An error that the user must resolve, worded "place: problem (why): remedy"."""


def main(name, work):
    """Calls work(). A Problem becomes a message and exit code 2."""
    try:
        work()
        sys.stdout.flush()
    except Problem as problem:
        sys.stdout.flush()
        print(f"{name}: {problem}", file=sys.stderr)
        sys.exit(2)


def answer(words, why):
    """The standard output of a command. Raises Problem that begins with `why` if it fails."""
    try:
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except OSError as error:
        raise Problem(f"{why}: {words[0]}: {error.strerror}") from None
    if done.returncode != 0:
        raise Problem(f"{why}: {(done.stderr or done.stdout).strip()}")
    return done.stdout


def program():
    """Path of montecarta: $MONTECARTA, the program built in this tree, or the one on the PATH."""
    built = HERE.parent / "build" / "montecarta"
    for path in (os.environ.get("MONTECARTA"), built, shutil.which("montecarta")):
        if path and os.access(path, os.X_OK):
            return str(Path(path).resolve())
    raise Problem(f"montecarta: not found (neither $MONTECARTA, nor {built}, nor on the PATH): "
                  "build it, or set MONTECARTA to it")


Plan = namedtuple("Plan", "sha256 runs cells shards program settings")


def plan_of(study_text, shards, settings):
    """The plan of a resolved study, which must not change between two calls of submit."""
    study = re.search(r"^\[study\]\n((?:[^\[].*\n|\n)*)", study_text, re.M).group(1)
    runs = int(re.search(r"^runs = (\d+)$", study, re.M).group(1))
    cells = len(re.findall(r"^cell = ", study_text, re.M))
    sha256 = hashlib.sha256(study_text.encode()).hexdigest()
    return Plan(sha256, runs, cells, shards, program(), settings)


def read_plan(folder):
    path = folder / "plan.json"
    try:
        return Plan(**json.loads(path.read_text()))
    except FileNotFoundError:
        raise Problem(f"{folder}: holds no plan (no plan.json): make one with "
                      "cluster/submit") from None
    except (OSError, ValueError, TypeError) as error:
        raise Problem(f"{path}: cannot be read ({error}): submit into another folder") from None


def write_whole(path, text):
    """Writes a file that gets its name only when it is complete."""
    draft = path.with_name(path.name + ".new")
    with open(draft, "w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    draft.replace(path)


def is_submitted(folder):
    """Whether submit made the folder, and not `montecarta work`."""
    return (folder / "logs").is_dir()


def claims(folder):
    """{index of a shard: text of the last claim on it by a worker of `montecarta work`}."""
    last = {}
    for path in (folder / "shards").glob("shard_*.h5.claim.*"):
        match = re.fullmatch(r"shard_(\d{4,})\.h5\.claim\.(\d+)", path.name)
        if match:
            index, number = int(match.group(1)), int(match.group(2))
            last[index] = max(last.get(index, (0, path)), (number, path))
    return {index: text_of(path) for index, (_, path) in last.items()}


def text_of(claim):
    try:
        return claim.read_text(errors="replace").strip()
    except OSError:  # removed meanwhile
        return ""


Stored = namedtuple("Stored", "state sha256 done failed missing seconds problem")


def shard_file(folder, index):
    return folder / "shards" / f"shard_{index:04d}.h5"


def index_of(name):
    """(index, is final) of a shard's file; (None, False) for other names."""
    match = re.fullmatch(r"shard_(\d{4,})\.h5(\.part(\..*)?)?", name)
    if not match or name.endswith(".new"):
        return None, False
    return int(match.group(1)), match.group(2) is None


def survey(folder, plan, whole=False):
    """({index: Stored} of final names, {index: Stored} of the unfinished files with most runs)."""
    paths = sorted(p for p in (folder / "shards").glob("shard_*.h5*")
                   if index_of(p.name)[0] is not None)
    if not paths:
        return {}, {}
    words = [program(), "status", "--each"] + (["--whole"] if whole else [])
    final, work = {}, {}
    for line in answer(words + [str(p) for p in paths], "the files of shards").splitlines():
        name, state, sha256, done, failed, missing, seconds, problem = line.split("\t")
        stored = Stored(state, sha256, int(done) + int(failed), int(failed), int(missing),
                        float(seconds), problem)
        index, is_final = index_of(Path(name).name)
        if is_final:
            final[index] = checked(stored, plan)
        elif index not in work or work[index].done < stored.done:
            work[index] = stored
    return final, work


def checked(stored, plan):
    """Treats a complete file of another study as damaged."""
    if stored.state == "complete" and stored.sha256 != plan.sha256:
        return stored._replace(state="damaged", problem="it belongs to another study")
    return stored


Task = namedtuple("Task", "job index state reason")


def job_name(folder):
    """Name of the jobs of a folder, which is unique to the folder."""
    letters = re.sub(r"[^A-Za-z0-9_.-]", "_", folder.name)[:24]
    return f"mc-{letters}-{hashlib.sha256(str(folder).encode()).hexdigest()[:6]}"


def has_scheduler():
    return shutil.which("squeue") is not None


def queue(name):
    """Tasks with this job name that have not ended."""
    words = ["squeue", "--noheader", "--array", "--user", str(os.getuid()), "--name", name,
             "--format", "%F|%K|%T|%r"]
    tasks = []
    for line in answer(words, "the scheduler cannot be asked (nothing was changed)").splitlines():
        job, index, state, reason = line.strip().split("|", 3)
        tasks.append(Task(job, int(index) if index.isdigit() else None, state, reason))
    return tasks


def is_stuck(task):
    """Whether the scheduler holds a task after failures or too many restarts, so that it will never
    start it again. False for a task that the user holds."""
    return task.state == "PENDING" and task.reason.lower().replace("_", " ") in (
        "launch failed requeued held", "job requeued in held state", "jobholdmaxrequeue")


def task_id(task):
    return task.job if task.index is None else f"{task.job}_{task.index}"


def ranges(indices):
    """Joins indices to ranges: 0, 1, 2, 3, 7 gives "0-3,7"."""
    parts = []
    for index in sorted(indices):
        if parts and index == parts[-1][1] + 1:
            parts[-1][1] = index
        else:
            parts.append([index, index])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in parts)
