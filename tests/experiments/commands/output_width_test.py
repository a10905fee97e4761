#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the commands print fits 80 columns in a file, and a terminal's width on a terminal.

usage: output_width_test.py MONTECARTA

Lists, help texts, plans of shipped studies and what is said about a small result are read from a
pipe, without COLUMNS. A pseudo terminal shows that lists follow its width and that the progress
redraws one line; where there is none that part is left out, and said so."""
import fcntl
import os
import pathlib
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios

KINDS = ("filters", "settings", "studies", "worlds", "metrics", "columns")
SOURCES = str(pathlib.Path(__file__).resolve().parents[3])
STUDIES = ("first_study", "calibration", "robots", "beyond_small_vehicle")
SMALL = ["--set", "study.runs=3"]


class Output:
    def __init__(self, program, folder):
        self.program, self.folder, self.faults = program, folder, []
        self.environment = {k: v for k, v in os.environ.items() if k != "COLUMNS"}

    def call(self, *words, codes=(0,)):
        done = subprocess.run([self.program, *words], cwd=self.folder, env=self.environment,
                              capture_output=True, text=True, timeout=200)
        if done.returncode not in codes:
            self.faults.append(f"{words}: exit code {done.returncode}: {done.stderr}")
        return done

    def expect_fit(self, *words, codes=(0,)):
        """Standard output of a call, whose lines must have 80 characters at most.

        Where the sources lie is not ours to shorten, so it counts as one character."""
        text = self.call(*words, codes=codes).stdout.replace(SOURCES, "/")
        self.faults += [f"{' '.join(words)}: {len(line)} characters: {line}"
                        for line in text.splitlines() if len(line) > 80]
        if not text:
            self.faults.append(f"{' '.join(words)}: prints nothing")
        return text

    def on_terminal(self, width, *words):
        """All that a call writes to a terminal of that width."""
        outside, inside = pty.openpty()
        fcntl.ioctl(inside, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
        environment = dict(self.environment, TERM="xterm")
        with subprocess.Popen([self.program, *words], cwd=self.folder, env=environment,
                              stdout=inside, stderr=inside) as process:
            os.close(inside)
            text = b""
            try:
                while part := os.read(outside, 4096):
                    text += part
            except OSError:  # the other end is closed
                pass
            if process.wait() != 0:
                self.faults.append(f"{words} on a terminal: exit code {process.returncode}")
        os.close(outside)
        return text.decode()


def names_in(listed):
    """What a list names: the first word of a line, behind its section if it has one."""
    section, names = "", []
    for line in listed.splitlines():
        if heading := re.match(r"\[(\w+)\] ", line):
            section = heading[1] + "."
        elif entry := re.match(r" {0,2}(\w+)  +\S", line):
            names.append(section + entry[1])
    return names


def check_lists(output):
    for kind in KINDS:
        names = names_in(output.expect_fit("list", kind))
        if len(names) < 3:
            output.faults.append(f"list {kind}: {names}")
            continue
        for name in names:
            if name.split(".")[-1] not in output.expect_fit("list", kind, name):
                output.faults.append(f"list {kind} {name}: does not say its name")
        refused = output.call("list", kind, names[1] + "_", codes=(2,))
        if refused.stdout or f"did you mean {names[1]}" not in refused.stderr:
            output.faults.append(f"list {kind}: {refused.stderr}")


def check_helps(output):
    commands = re.findall(r"^  ([a-z]+)  +\S", output.expect_fit("--help"), re.MULTILINE)
    if len(commands) < 10:
        output.faults.append(f"--help: {commands}")
    for command in commands:
        if f"  montecarta {command}" not in output.expect_fit(command, "--help"):
            output.faults.append(f"{command} --help: no example")


def check_plans(output):
    for study in STUDIES:
        head = output.expect_fit("check", study).split("\n\n")[1]
        if not all(re.search(rf"^  {word} +\S", head, re.MULTILINE)
                   for word in ("time", "file", "filters", "runs")):
            output.faults.append(f"check {study}: begins with {head}")
    output.expect_fit("plan", "--dim", "3", "--ratio", "1.2", "--scans", "100")
    output.expect_fit("tune", "first_study", "--cell", "ekf_slam", "--set", "study.runs=20")


def check_result(output):
    log = output.call("run", "first_study", "-o", "out.h5", *SMALL).stderr
    if "\r" in log or "%" in log:
        output.faults.append(f"a study of seconds has progress in a log: {log}")
    output.expect_fit("analyze", "out.h5")
    output.expect_fit("analyze", "out.h5", "--all")
    output.expect_fit("compare", "out.h5", "--baseline", "ekf_slam")
    output.expect_fit("compare", "out.h5", "--baseline", "ekf_slam", "--all")
    output.expect_fit("info", "out.h5")
    output.expect_fit("status", "out.h5")
    output.expect_fit("verify", "out.h5", "--sample", "2")
    output.expect_fit("gate", "out.h5", "--cell", "ekf_slam", codes=(0, 4, 5))


def check_terminal(output, width):
    longest = max(map(len, output.on_terminal(width, "list", "settings").splitlines()))
    if not min(width, 80) - 20 < longest <= width:
        output.faults.append(f"list settings: {longest} of {width} columns of a terminal")
    shown = output.on_terminal(width, "run", "first_study", "-o", f"{width}.h5", *SMALL)
    lines = [line for line in shown.split("\n") if "\r" in line.rstrip("\r")]
    drawn = lines[0].rstrip("\r").split("\r")[1:] if len(lines) == 1 else []
    if not drawn or any(not d.endswith("\x1b[K") or len(d) - 3 >= width for d in drawn):
        output.faults.append(f"progress on {width} columns: {lines}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        output = Output(str(pathlib.Path(sys.argv[1]).resolve()), folder)
        for check in (check_lists, check_helps, check_plans, check_result):
            check(output)
        try:
            os.close(os.open("/dev/ptmx", os.O_RDWR | os.O_NOCTTY))
        except OSError:
            print("this machine gives no pseudo terminal")
        else:
            for width in (60, 80, 160):
                check_terminal(output, width)
    print("\n".join(output.faults[:50]) or "everything fits")
    print(len(output.faults), "faults")
    return 1 if output.faults else 0


if __name__ == "__main__":
    sys.exit(main())
