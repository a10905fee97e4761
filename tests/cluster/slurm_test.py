# SPDX-License-Identifier: BSD-3-Clause
"""cluster/submit, status and cancel against a real Slurm, with every fault a cluster has to offer.

usage: slurm_test.py MONTECARTA      (exit code 77, with the reason, where there can be no Slurm)

A few scenarios run at the same time, each on nodes of its own; each test waits for its scenario, as
long as anything changes: no test depends on the speed of the machine. All end the same way: submit
again, and the file equals that of a single machine, byte for byte.
"""
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import private_slurm
from private_slurm import is_alive, kill
from submitted_study import STUDY, TOP, Case, Ground, call, of_study

PARTITIONS = {
    "main": ("n[1-4]", "Default=YES"),
    "crash": ("n5", ""),
    "dying": ("n[6-7]", ""),
    "cut": ("n[8-9]", ""),
    "low": ("n10", "PriorityTier=1"),
    "high": ("n10", "PriorityTier=10 PreemptMode=OFF"),
    "short": ("n11", ""),
    "full": ("n12", ""),
    "cancel": ("n13", ""),
}


def array_of_eight(ground):
    case = Case(ground, "main", shards=8)
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


def killed_then_requeued_then_truncated(ground):
    case = Case(ground, "crash")
    case.submit()
    pid, shard = case.caught("n5")
    kill(pid, signal.SIGKILL)
    case.wait_for("the failure", lambda: "failed on" in case.log(f"shard_{shard:04d}.log"))
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


def node_dies(ground):
    case = Case(ground, "dying")
    case.submit()
    _, shard = case.caught("n6")
    ground.slurm.kill_node("n6")
    case.wait_for("the task elsewhere", lambda: case.copy_on("n7", shard))
    ground.slurm.start_node("n6")
    case.finish()


def node_is_cut_off(ground):
    """Two copies of one shard at the same time, one of which nobody can reach."""
    case = Case(ground, "cut")
    case.submit()
    pid, shard = case.caught("n8")
    ground.slurm.cut_node("n8")
    case.wait_for("the second copy", lambda: case.copy_on("n9", shard))
    case.wait_for("a name of its own", lambda: len(case.attempts(shard)) == 2)
    kill(pid, signal.SIGCONT)
    case.wait_for("the end of the cut-off copy", lambda: not is_alive(pid))
    ground.slurm.heal_node("n8")
    case.finish()


def preempted(ground):
    case = Case(ground, "low")
    case.submit("--no-kill")
    pid, shard = case.caught("n10")
    call(["sbatch", "-p", "high", "-o", "/dev/null", "--wrap", "sleep 2"])
    case.checkpointed(pid, shard)
    case.finish()


def walltime(ground):
    case = Case(ground, "short", shards=1)
    # Slurm takes up to 30 s more: soon after the start.
    case.submit("--time=1", "--signal=B:TERM@28")
    case.checkpointed(*case.caught("n11"))
    case.finish()


def limit_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))  # [byte]; sbatch hands it on


def full_disk(ground):
    """A disk of 32 kB; who may not mount one gets a limit on the size of files instead."""
    case = Case(ground, "full")
    small = case.folder / "shards"
    small.mkdir(parents=True)
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=32k", "none", str(small)],
                             stderr=subprocess.DEVNULL).returncode == 0
    try:
        case.submit(preexec_fn=None if mounted else limit_files)
        case.idle()
        said = case.log("shard_0000.log")
        assert ("free space" if mounted else "ulimit -f") in said, said
        assert not list(small.glob("*.h5")) and "4 failed" in case.status(), case.status()
    finally:
        if mounted:
            call(["umount", "-l", small])
    case.finish()


def cancelled(ground):
    case = Case(ground, "cancel")
    case.submit()
    pid, shard = case.caught("n13")
    told = call([TOP / "cluster/cancel", case.folder])
    assert re.search(r"\d shards and 1 merges taken back", told), told
    case.checkpointed(pid, shard)
    case.idle()
    assert "1 checkpointed" in case.status(), case.status()
    case.finish()


def controller_dies(ground):
    """After all others, for whom it would be one fault too many."""
    case = Case(ground, "controller", partition="main")
    case.submit()
    pid, _ = case.caught("n1")
    ground.slurm.kill("slurmctld")
    assert "cannot be asked" in case.submit(code=2)
    kill(pid, signal.SIGCONT)
    assert "cannot be asked" in case.status()
    case.wait_for("the end of the task", lambda: not is_alive(pid))
    ground.slurm.start_controller()
    case.wait_for("the controller", lambda: ground.slurm.states())
    case.wait_for("an end", lambda: ground.slurm.revive() or case.at_rest())
    case.finish()


# Those that wait longest for Slurm go first.
SCENARIOS = (walltime, node_is_cut_off, node_dies, killed_then_requeued_then_truncated, preempted,
             cancelled, array_of_eight, full_disk)
AT_ONCE = 3  # more would be too much for two processors


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pool = ThreadPoolExecutor(AT_ONCE)
        cls.running = {scenario: cls.pool.submit(scenario, cls.ground) for scenario in SCENARIOS}

    def outcome(self, scenario):
        self.running[scenario].result()

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
        case = Case(self.ground, "wrong", shards=102, partition="main")
        self.assertIn("more runs", case.submit(code=2).replace("one of the study's", "more runs"))
        study = self.ground.folder / "many.ini"
        study.write_text(STUDY.format(particles=10).replace("runs = 24", "runs = 900"))
        submit = [TOP / "cluster/submit", study, "-o", case.folder, "--shards"]
        many = call(submit + ["102"], 2)
        self.assertIn("MaxArraySize is 101", many)
        self.assertIn("choose --shards 101 or fewer, of 9 runs or more", many)
        self.assertFalse(case.folder.exists())
        early = call(submit + ["4", "--set", "study.until=position_rmse < 1"], 2)
        self.assertIn("--set study.until=", early)
        named = self.ground.folder / "named.ini"
        named.write_text(STUDY.format(particles=10).replace(
            "ekf_slam", "external command=true label=mine"))
        words = [TOP / "cluster/submit", named, "-o", case.folder, "--shards", "4", "--dry-run"]
        self.assertIn("add --allow-external", call(words, 2))
        self.assertRegex(call(words + ["--allow-external"], 0), r"task\.sh .* --allow-external\n")
        refused = Case(self.ground, "refused", partition="nowhere").submit(code=2)
        self.assertIn("sbatch refused", refused)
        other = Case(self.ground, "main", shards=4).submit(code=2)
        self.assertIn("is cut into 8", other)

    def test_2_the_controller_dies(self):
        for running in self.running.values():
            running.exception()
        controller_dies(self.ground)
        times = self.ground.stopped_in
        print("SIGTERM to exit [s]:", ", ".join(f"{seconds:.2f}" for seconds in times))


def main():
    reason = private_slurm.why_not()
    if reason:
        print(f"skipped: no private Slurm here: {reason}")
        sys.exit(77)
    program = str(Path(sys.argv.pop(1)).resolve())
    for name in [name for name in os.environ if name.startswith(("SLURM_", "SBATCH_"))]:
        del os.environ[name]
    os.environ.update(MONTECARTA=program, MONTECARTA_MERGE_WAIT="2", MONTECARTA_THREADS="1")
    with tempfile.TemporaryDirectory(prefix="montecarta-slurm-") as folder:
        Slurm.ground = Ground(folder, program)
        slurm = Slurm.ground.slurm = private_slurm.PrivateSlurm(f"{folder}/slurm", 13, PARTITIONS)
        try:
            try:
                slurm.up()
            except (OSError, TimeoutError) as error:
                print(f"skipped: no private Slurm here: {error}")
                sys.exit(77)
            tests = unittest.main(exit=False, verbosity=2)
        finally:
            slurm.down()
    sys.exit(not tests.result.wasSuccessful())


if __name__ == "__main__":
    main()
