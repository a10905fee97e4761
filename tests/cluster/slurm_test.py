# SPDX-License-Identifier: BSD-3-Clause
"""cluster/submit, status and cancel against a real Slurm, with every fault a cluster has to offer.

usage: slurm_test.py MONTECARTA      (exit code 77, with the reason, where there can be no Slurm)

The scenarios run at the same time, each on nodes of its own; each test waits for its scenario. All
end the same way: submit again, and the file equals that of a single machine, byte for byte.
"""
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import private_slurm
from private_slurm import kill, wait_for

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "cluster"))
import shards as of_study  # noqa: E402  (what submit itself asks the scheduler)

SECONDS = []  # [s] from SIGTERM to exit
LIMIT = 120  # [s] for whatever a scenario waits for

# A shard of six runs takes a second or more of one processor: long enough to be caught at work.
STUDY = """[study]
name = faults
runs = 24
[scenario]
world = dense_loop
loops = 1
[cells]
cell = ufastslam particles={particles}
cell = ekf_slam
[record]
columns = pose
rate = scan
"""

PARTITIONS = {
    "main": ("n[1-4]", "Default=YES"),
    "crash": ("n5", ""),
    "dying": ("n[6-7]", ""),
    "cut": ("n[8-9]", ""),
    "low": ("n10", "PriorityTier=1"),
    "high": ("n10", "PriorityTier=10 PreemptMode=OFF"),
    "short": ("n11", ""),
    "full": ("n12", ""),
}


def call(words, code=0, **more):
    """Standard output and error of a command that must end with `code`."""
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode != code:
        raise AssertionError(f"{words}: exit code {done.returncode}, not {code}:\n{done.stdout}")
    return done.stdout


class Case:
    """A folder in which the study is submitted to a partition."""

    def __init__(self, name, shards=4, partition=None):
        self.name, self.shards, self.partition = name, shards, partition or name
        self.folder = FOLDER / name

    def submit(self, *more, code=0):
        return call([TOP / "cluster/submit", FOLDER / "study.ini", "-o", self.folder, "--shards",
                     self.shards, "-p", self.partition, "--time=5", *more], code)

    def status(self):
        return call([TOP / "cluster/status", self.folder])

    def log(self, name):
        path = self.folder / "logs" / name
        return path.read_text() if path.exists() else ""

    def tasks(self):
        """What the scheduler has not finished with, merge included."""
        name = of_study.job_name(self.folder)
        return of_study.queue(name) + of_study.queue(name + "-merge")

    def half_done(self, shard):
        """Whether an attempt at a shard has stored some of its runs and not all."""
        files = [str(p) for p in (self.folder / "shards").glob(f"shard_{shard:04d}.h5.part*")
                 if not p.name.endswith(".new")]
        lines = call([PROGRAM, "status", "--each"] + files).splitlines() if files else []
        return any(line.split("\t")[1] == "unfinished" and line.split("\t")[3] != "0"
                   for line in lines)

    def at_work(self, node):
        """[(process, shard)] on a node."""
        lines = [(pid, private_slurm.command(Path(f"/proc/{pid}")))
                 for pid in SLURM.tasks_on(node, program=PROGRAM)]
        return [(pid, int(re.search(r"--shard (\d+)/", line).group(1))) for pid, line in lines
                if f" {self.folder}/" in line]

    def copy_on(self, node, shard):
        return shard in [at for _, at in self.at_work(node)]

    def caught(self, node):
        """(process, shard) at work on a node, frozen when it has stored some runs and not all."""
        def found():
            for pid, shard in self.at_work(node):
                kill(pid, signal.SIGSTOP)
                if self.half_done(shard):
                    return pid, shard
                kill(pid, signal.SIGCONT)
            return None
        return wait_for(f"{self.name}: a task at work on {node}", found, LIMIT)

    def checkpointed(self, pid, shard):
        """Lets a frozen task hear the SIGTERM that is due, and waits for its checkpoint."""
        wait_for(f"{self.name}: SIGTERM", lambda: private_slurm.is_pending(pid, signal.SIGTERM), LIMIT)
        began = time.monotonic()
        kill(pid, signal.SIGCONT)
        wait_for(f"{self.name}: an end", lambda: not private_slurm.is_alive(pid), LIMIT)
        SECONDS.append(time.monotonic() - began)
        wait_for(f"{self.name}: a checkpoint",
                 lambda: "task: checkpoint" in self.log(f"shard_{shard:04d}.log"), LIMIT)

    def idle(self):
        """Waits until the scheduler has nothing more to do here."""
        wait_for(f"{self.name}: an end", lambda: not self.tasks(), LIMIT)

    def finish(self):
        """Nothing is left to the scheduler; submit again until the result is there; compare."""
        self.idle()
        for _ in range(3):
            if (self.folder / "result.h5").exists():
                break
            self.submit()
            self.idle()
        equal(self.folder / "result.h5")
        left = sorted(p.name for p in (self.folder / "shards").iterdir() if ".part" in p.name)
        if left:
            raise AssertionError(f"{self.name}: left over: {left}")
        if not self.submit().startswith("complete: "):
            raise AssertionError(f"{self.name}: not complete")


def equal(path):
    for group in ("/cells", "/truth", "/scenario"):
        call(["h5diff", path, FOLDER / "single.h5", group, group])


def array_of_eight():
    case = Case("main", shards=8)
    told = case.submit("--dry-run")
    assert "--array=0-7" in told and "afterany:JOB" in told and not case.folder.exists(), told
    told = case.submit()
    assert "8 missing" in told and "cluster/status" in told, told
    told = case.submit()
    assert "0 missing" in told, told
    status = case.status()
    assert re.search(r"shards  .* of 8", status), status
    case.finish()
    assert (case.folder / "verdict.txt").read_text().find("ekf_slam") >= 0
    assert "8 done of 8" in case.status() and "merge   done" in case.status(), case.status()
    assert not list((case.folder / "logs").glob("shard_*")), "no log of a task that went well"


def killed_then_requeued_then_truncated():
    case = Case("crash")
    case.submit()
    pid, shard = case.caught("n5")
    kill(pid, signal.SIGKILL)
    wait_for("the failure", lambda: "failed on" in case.log(f"shard_{shard:04d}.log"), LIMIT)
    pid, other = case.caught("n5")
    task = next(task for task in case.tasks() if task.index == other)
    call(["scontrol", "requeue", of_study.task_id(task)])
    case.checkpointed(pid, other)
    case.idle()
    assert f"failed  shard {shard}" in case.status(), case.status()
    assert "runs " in case.log("merge.log"), case.log("merge.log")
    whole = next(i for i in range(4) if i != shard)
    path = case.folder / "shards" / f"shard_{whole:04d}.h5"
    os.truncate(path, path.stat().st_size // 2)
    told = case.submit()
    assert "is damaged" in told and "2 missing" in told, told
    case.finish()


def node_dies():
    case = Case("dying")
    case.submit()
    _, shard = case.caught("n6")
    SLURM.kill_node("n6")
    wait_for("the task elsewhere", lambda: case.copy_on("n7", shard), LIMIT)
    SLURM.start_node("n6")
    case.finish()


def node_is_cut_off():
    """Two copies of one shard at the same time, one of which nobody can reach."""
    case = Case("cut")
    case.submit()
    pid, shard = case.caught("n8")
    SLURM.cut_node("n8")
    wait_for("the second copy", lambda: case.copy_on("n9", shard), LIMIT)
    kill(pid, signal.SIGCONT)
    wait_for("the end of the cut-off copy", lambda: not private_slurm.is_alive(pid), LIMIT)
    SLURM.heal_node("n8")
    case.finish()


def preempted():
    case = Case("low")
    case.submit("--no-kill")
    pid, shard = case.caught("n10")
    call(["sbatch", "-p", "high", "-o", "/dev/null", "--wrap", "sleep 2"])
    case.checkpointed(pid, shard)
    case.finish()


def walltime():
    case = Case("short", shards=1)
    case.submit("--time=1", "--signal=B:TERM@28")  # Slurm takes up to 30 s more: soon after the start
    case.checkpointed(*case.caught("n11"))
    case.finish()


def full_disk():
    case = Case("full")
    small = case.folder / "shards"
    small.mkdir(parents=True)
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=32k", "none", str(small)],
                             stderr=subprocess.DEVNULL).returncode == 0
    if not mounted:
        return "no full disk: this user may not mount one"
    try:
        case.submit()
        case.idle()
        assert "free space" in case.log("shard_0000.log"), case.log("shard_0000.log")
        assert not list(small.glob("*.h5")) and "4 failed" in case.status(), case.status()
    finally:
        call(["umount", "-l", small])
    case.finish()
    return None


def cancelled():
    case = Case("cancel", partition="short")
    case.submit()
    pid, shard = case.caught("n11")
    told = call([TOP / "cluster/cancel", case.folder])
    assert re.search(r"\d shards and 1 merges taken back", told), told
    case.checkpointed(pid, shard)
    case.idle()
    assert "1 checkpointed" in case.status(), case.status()
    case.finish()


def controller_dies():
    """After all others, for whom it would be one fault too many."""
    case = Case("controller", partition="main")
    case.submit()
    pid, _ = case.caught("n1")
    SLURM.kill("slurmctld")
    assert "cannot be asked" in case.submit(code=2)
    kill(pid, signal.SIGCONT)
    assert "cannot be asked" in case.status()
    wait_for("the end of the task", lambda: not private_slurm.is_alive(pid), LIMIT)
    SLURM.start_controller()
    wait_for("the controller", lambda: SLURM.states(), 30)
    for name in SLURM.names:
        subprocess.run(["scontrol", "update", f"nodename={name}", "state=resume"],
                       stderr=subprocess.DEVNULL)
    case.finish()


SCENARIOS = (array_of_eight, killed_then_requeued_then_truncated, node_dies, node_is_cut_off,
             preempted, walltime, full_disk)


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pool = ThreadPoolExecutor(len(SCENARIOS))
        cls.running = {scenario: cls.pool.submit(scenario) for scenario in SCENARIOS}
        cls.running[cancelled] = cls.pool.submit(lambda: (cls.running[walltime].exception(),
                                                          cancelled()))

    def outcome(self, scenario):
        reason = self.running[scenario].result()
        if isinstance(reason, str):
            self.skipTest(reason)

    def test_1_array_of_eight_shards_on_four_nodes_equals_one_machine(self):
        self.outcome(array_of_eight)

    def test_1_kill_9_and_requeue_and_a_truncated_shard(self):
        self.outcome(killed_then_requeued_then_truncated)

    def test_1_a_node_dies(self):
        self.outcome(node_dies)

    def test_1_a_node_is_cut_off_and_goes_on(self):
        self.outcome(node_is_cut_off)

    def test_1_preemption(self):
        self.outcome(preempted)

    def test_1_walltime(self):
        self.outcome(walltime)

    def test_1_full_disk(self):
        self.outcome(full_disk)

    def test_1_cancel(self):
        self.outcome(cancelled)

    def test_1_wrong_input_is_named(self):
        case = Case("wrong", shards=102, partition="main")
        self.assertIn("more runs", case.submit(code=2).replace("one of the study's", "more runs"))
        (FOLDER / "many.ini").write_text(STUDY.format(particles=10).replace("runs = 24", "runs = 900"))
        many = call([TOP / "cluster/submit", FOLDER / "many.ini", "-o", case.folder, "--shards", "102"],
                    2)
        self.assertIn("MaxArraySize is 101", many)
        self.assertIn("choose --shards 101 or fewer, of 9 runs or more", many)
        self.assertFalse(case.folder.exists())
        refused = Case("refused", partition="nowhere").submit(code=2)
        self.assertIn("sbatch refused", refused)
        other = Case("main", shards=4).submit(code=2)
        self.assertIn("is cut into 8", other)

    def test_2_the_controller_dies(self):
        for running in self.running.values():
            running.exception()
        controller_dies()
        print(f"SIGTERM to exit: {min(SECONDS):.2f} to {max(SECONDS):.2f} s, {len(SECONDS)} times")


def main():
    global FOLDER, SLURM, PROGRAM
    PROGRAM = os.environ["MONTECARTA"] = str(Path(sys.argv.pop(1)).resolve())
    reason = private_slurm.why_not()
    if reason:
        print(f"skipped: no private Slurm here: {reason}")
        sys.exit(77)
    os.environ.update(MONTECARTA_MERGE_WAIT="2", MONTECARTA_THREADS="1")
    for name in [name for name in os.environ if name.startswith(("SLURM_", "SBATCH_"))]:
        del os.environ[name]
    with tempfile.TemporaryDirectory(prefix="montecarta-slurm-") as folder:
        FOLDER = Path(folder)
        (FOLDER / "study.ini").write_text(STUDY.format(particles=300))
        call([PROGRAM, "run", FOLDER / "study.ini", "-o", FOLDER / "single.h5", "--quiet"])
        SLURM = private_slurm.PrivateSlurm(FOLDER / "slurm", 12, PARTITIONS)
        try:
            try:
                SLURM.up()
            except (OSError, TimeoutError) as error:
                print(f"skipped: no private Slurm here: {error}")
                sys.exit(77)
            program = unittest.main(exit=False, verbosity=2)
        finally:
            SLURM.down()
    sys.exit(not program.result.wasSuccessful())


if __name__ == "__main__":
    main()
