# SPDX-License-Identifier: BSD-3-Clause
"""A private, throw-away Slurm of many nodes on this one machine, with faults to inject.

Real slurmctld, slurmd and munged, as whoever calls, below one folder: no root, no systemd, no
cgroups, no database, nothing in /etc. The daemons are children of the test and die with it.
"""
import ctypes
import os
import pwd
import random
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

STILL = 120  # [s] without any change, after which a test gives up
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "h5diff")


def why_not():
    """Why there can be no private Slurm here; None where there can."""
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    absent = [name for name in NEEDED if shutil.which(name) is None]
    if absent:
        return f"not installed: {', '.join(absent)} (bash .ci/install-packages test)"
    return None


def wait_for(what, condition, folder):
    """The first true value of `condition`, as long as anything below `folder` changes.

    So a loaded machine may take its time. An error that says `what` did not come if nothing has
    changed for STILL seconds."""
    seen, since = None, time.monotonic()
    while True:
        found = condition()
        if found:
            return found
        now = contents(folder)
        if now != seen:
            seen, since = now, time.monotonic()
        elif time.monotonic() > since + STILL:
            raise TimeoutError(f"{what}: did not come, and nothing has changed for {STILL} s")
        time.sleep(0.25)


def contents(folder):
    """Names, sizes and times of all files below a folder: results, logs, those of Slurm too."""
    found = []
    for path, _, names in os.walk(folder):
        for name in names:
            try:
                status = os.lstat(os.path.join(path, name))
                found.append((path, name, status.st_size, status.st_mtime_ns))
            except OSError:  # removed meanwhile
                pass
    return sorted(found)


def free_ports(count):
    """The first of `count` ports in a row on which nobody listens."""
    for _ in range(50):
        base = random.SystemRandom().randrange(20000, 32000)
        probes = [socket.socket() for _ in range(count)]
        try:
            for i, probe in enumerate(probes):
                probe.bind(("127.0.0.1", base + i))
            return base
        except OSError:
            continue
        finally:
            for probe in probes:
                probe.close()
    raise RuntimeError("no free ports")


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


CONFIGURATION = """
ClusterName=private
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
# A requeued task starts when its old credential has expired; values below 5 silently mean 120.
AuthInfo=socket={folder}/munge.sock,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,sched_min_interval=1,bf_interval=1,bf_resolution=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
# Long enough that a loaded machine seems neither dead nor deaf to signals.
SlurmdTimeout=20
SlurmctldTimeout=30
KillWait=60
CompleteWait=0
InactiveLimit=0
MessageTimeout=15
BatchStartTimeout=60
JobRequeue=1
MaxArraySize=101
NodeName=DEFAULT CPUs=1 RealMemory=500 State=UNKNOWN
"""


class PrivateSlurm:
    """`partitions`: {name: (nodes, options)}, e.g. {"main": ("n[1-4]", "Default=YES")}."""

    def __init__(self, folder, nodes, partitions):
        self.folder, self.names = Path(folder), [f"n{i + 1}" for i in range(nodes)]
        self.daemons = {}
        port = free_ports(nodes + 2)
        for sub in ("state", "log"):
            (self.folder / sub).mkdir(parents=True)
        text = CONFIGURATION.format(folder=self.folder, user=pwd.getpwuid(os.getuid()).pw_name,
                                    port=port, node_port=port + 1)
        for i, name in enumerate(self.names):
            (self.folder / "spool" / name).mkdir(parents=True)
            text += (f"NodeName={name} NodeHostname=localhost NodeAddr=127.0.0.1 "
                     f"Port={port + 2 + i}\n")
        for name, (of, options) in partitions.items():
            text += f"PartitionName={name} Nodes={of} MaxTime=INFINITE State=UP {options}\n"
        (self.folder / "slurm.conf").write_text(text)
        old = subprocess.run(["slurmd", "-V"], stdout=subprocess.PIPE, text=True).stdout.split()[-1]
        plugin = "cgroup/v1" if old < "23.11" else "disabled"  # no cgroups: v1 is not probed either
        (self.folder / "cgroup.conf").write_text(f"CgroupPlugin={plugin}\n")
        os.environ["SLURM_CONF"] = str(self.folder / "slurm.conf")

    def start(self, name, words):
        with open(self.folder / "log" / f"{name}.out", "ab") as log:
            self.daemons[name] = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log,
                                                  stderr=log, preexec_fn=die_with_parent,
                                                  cwd=self.folder, start_new_session=True)

    def up(self):
        key = self.folder / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(128))
        self.folder.chmod(0o755)
        self.start("munged", ["munged", "--foreground", "--force", f"--key-file={key}",
                              f"--socket={self.folder}/munge.sock",
                              f"--pid-file={self.folder}/munge.pid",
                              f"--log-file={self.folder}/log/munge", "--num-threads=2",
                              f"--seed-file={self.folder}/munge.seed"])
        wait_for("munged", (self.folder / "munge.sock").exists, self.folder)
        self.start_controller("-c")
        for name in self.names:
            self.start_node(name)
        wait_for("idle nodes", lambda: self.states().count("idle") == len(self.names),
                 self.folder)

    def start_controller(self, *options):
        self.start("slurmctld", ["slurmctld", "-D", *options, "-L", f"{self.folder}/log/slurmctld"])

    def start_node(self, name):
        self.start(name, ["slurmd", "-D", "-N", name, "-L", f"{self.folder}/log/slurmd.{name}"])

    def node_states(self):
        """{node: state}, as the controller sees them; empty where it does not answer."""
        done = subprocess.run(["sinfo", "-h", "-N", "-o", "%N %T"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True)
        return dict(line.split() for line in done.stdout.splitlines())

    def states(self):
        return list(self.node_states().values())

    def revive(self):
        """What an administrator does when the controller left nodes down or drained."""
        for name, state in self.node_states().items():
            if state.startswith(("down", "drain")):
                subprocess.run(["scontrol", "update", f"nodename={name}", "state=resume"],
                               stderr=subprocess.DEVNULL)

    def kill(self, name):
        self.daemons[name].kill()
        self.daemons[name].wait()

    def kill_node(self, name):
        """The node dies: its slurmd, its slurmstepds and all that its jobs run."""
        self.kill(name)
        self.kill_steps(name)

    def kill_steps(self, name):
        """First the slurmstepds, which hold the log of their node open, then what they run."""
        log = f"{self.folder}/log/slurmd.{name}"
        for pid in pids(lambda process: log in open_files(process)) + self.tasks_on(name):
            if pid != self.daemons[name].pid:
                kill(pid, signal.SIGKILL)

    def cut_node(self, name):
        """Nobody reaches the node any more, and its jobs go on."""
        self.daemons[name].send_signal(signal.SIGSTOP)

    def heal_node(self, name):
        self.daemons[name].send_signal(signal.SIGCONT)

    def tasks_on(self, name, *, program=""):
        """Processes of jobs on a node whose command begins with `program`."""
        mine = (f"SLURMD_NODENAME={name}".encode(), f"SLURM_CONF={self.folder}/slurm.conf".encode())
        return pids(lambda p: all(word in environment(p) for word in mine) and
                    command(p).startswith(program))

    def down(self):
        for daemon in self.daemons.values():
            daemon.send_signal(signal.SIGCONT)
        for name in self.names:
            self.kill_steps(name)
        for daemon in self.daemons.values():
            daemon.terminate()
        for daemon in self.daemons.values():
            try:
                daemon.wait(5)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()


def kill(pid, number):
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        pass


def pids(condition):
    return [int(p.name) for p in Path("/proc").glob("[0-9]*") if condition(p)]


def field(pid, name):
    """Of /proc/PID/status; "" where the process is gone."""
    for line in readable(Path(f"/proc/{pid}/status")).decode().splitlines():
        if line.startswith(name + ":"):
            return line.split(":")[1].strip()
    return ""


def is_alive(pid):
    return field(pid, "State")[:1] not in ("", "Z", "X")


def is_pending(pid, number):
    """Whether a frozen process was sent a signal; true also where it ended of another."""
    return not is_alive(pid) or int(field(pid, "ShdPnd") or "0", 16) >> (number - 1) & 1


def readable(path):
    try:
        return path.read_bytes()
    except OSError:
        return b""


def environment(process):
    return readable(process / "environ").split(b"\0")


def command(process):
    return readable(process / "cmdline").replace(b"\0", b" ").decode(errors="replace")


def open_files(process):
    try:
        return [os.readlink(link) for link in (process / "fd").iterdir()]
    except OSError:
        return []


if __name__ == "__main__" and why_not():
    print(f"\nThe tests of cluster/ will be skipped: {why_not()}")
