# SPDX-License-Identifier: BSD-3-Clause
"""A study submitted to the private Slurm, and what a test does to it."""
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import private_slurm
from private_slurm import kill

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "cluster"))
import shards as of_study  # noqa: E402  (what submit itself asks the scheduler)

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

class Ground:
    """What all cases share: a folder, the executable, the cluster, the single machine's result."""

    def __init__(self, folder, program):
        self.folder, self.program, self.slurm = Path(folder), program, None
        self.stopped_in = []  # [s] from SIGTERM to exit
        self.study = self.folder / "study.ini"
        self.single = self.folder / "single.h5"
        self.study.write_text(STUDY.format(particles=300))
        call([program, "run", self.study, "-o", self.single, "--quiet"])


def call(words, code=0, **more):
    """Standard output and error of a command that must end with `code`."""
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode != code:
        raise AssertionError(f"{words}: exit code {done.returncode}, not {code}:\n{done.stdout}")
    return done.stdout


class Case:
    """A folder in which the study is submitted to a partition."""

    def __init__(self, ground, name, shards=4, partition=None):
        self.ground, self.name, self.shards = ground, name, shards
        self.partition, self.folder = partition or name, ground.folder / name

    def submit(self, *more, code=0, **options):
        return call([TOP / "cluster/submit", self.ground.study, "-o", self.folder, "--shards",
                     self.shards, "-p", self.partition, "--time=5", *more], code, **options)

    def wait_for(self, what, condition):
        return private_slurm.wait_for(f"{self.name}: {what}", condition, self.ground.folder)

    def status(self):
        return call([TOP / "cluster/status", self.folder])

    def log(self, name):
        path = self.folder / "logs" / name
        return path.read_text() if path.exists() else ""

    def tasks(self):
        """What the scheduler has not finished with, merge included."""
        name = of_study.job_name(self.folder)
        return of_study.queue(name) + of_study.queue(name + "-merge")

    def attempts(self, shard):
        """The files of attempts at a shard."""
        return [str(p) for p in (self.folder / "shards").glob(f"shard_{shard:04d}.h5.part.*")
                if not p.name.endswith(".new")]

    def half_done(self, shard):
        """Whether an attempt at a shard has stored some of its runs and not all."""
        files = self.attempts(shard)
        if not files:
            return False
        lines = call([self.ground.program, "status", "--each"] + files).splitlines()
        return any(line.split("\t")[1] == "unfinished" and line.split("\t")[3] != "0"
                   for line in lines)

    def at_work(self, node):
        """[(process, shard)] on a node."""
        lines = [(pid, private_slurm.command(Path(f"/proc/{pid}")))
                 for pid in self.ground.slurm.tasks_on(node, program=self.ground.program)]
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
        return self.wait_for(f"a task at work on {node}", found)

    def checkpointed(self, pid, shard):
        """Lets a frozen task hear the SIGTERM that is due, and waits for its checkpoint."""
        self.wait_for("SIGTERM", lambda: private_slurm.is_pending(pid, signal.SIGTERM))
        if private_slurm.is_alive(pid):  # Slurm may have woken it up itself
            began = time.monotonic()
            kill(pid, signal.SIGCONT)
            self.wait_for("an end", lambda: not private_slurm.is_alive(pid))
            self.ground.stopped_in.append(time.monotonic() - began)
        self.wait_for("a checkpoint",
                      lambda: "task: checkpoint" in self.log(f"shard_{shard:04d}.log"))

    def at_rest(self):
        """Whether the scheduler has nothing more to do here, or put aside what it had."""
        tasks = self.tasks()
        stuck = [task for task in tasks if of_study.is_stuck(task)]
        return not tasks or (stuck and all(task in stuck or task.reason == "Dependency"
                                           for task in tasks))

    def idle(self):
        try:
            self.wait_for("an end", self.at_rest)
        except TimeoutError as error:
            raise TimeoutError(f"{error}: {self.tasks()}, nodes "
                               f"{self.ground.slurm.states()}") from None

    def finish(self):
        """Nothing is left to the scheduler; submit again until the result is there; compare."""
        self.idle()
        for _ in range(3):
            if (self.folder / "result.h5").exists():
                break
            self.submit()
            self.idle()
        for group in ("/cells", "/truth", "/scenario"):
            call(["h5diff", self.folder / "result.h5", self.ground.single, group, group])
        left = sorted(p.name for p in (self.folder / "shards").iterdir() if ".part" in p.name)
        if left:
            raise AssertionError(f"{self.name}: left over: {left}")
        if not self.submit().startswith("complete: "):
            raise AssertionError(f"{self.name}: not complete")
