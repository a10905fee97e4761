# SPDX-License-Identifier: BSD-3-Clause
"""Damaged studies, worlds, logs and estimates through the real program: it says what is wrong, and
soon.

usage: damaged_texts.py MONTECARTA [COUNT [FIRST]]      (default: 150 damaged texts, from seed 0)

Bytes are changed, lines are repeated, dropped and swapped, numbers become extreme, and the end is
cut off. Allowed are the exit codes 0 and 2 (3: some runs failed) within 10 s of processor time and
2 GB; a refusal names the file or the option. A text that breaks this is kept, and named.
"""
import collections
import itertools
import os
import random
import re
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import damaged_results

STUDY = damaged_results.STUDY.replace("runs = 4", "runs = 2\nuntil = verdict")
WORLD = damaged_results.WORLD
POSE = "time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_0,cov_1_1,cov_1_2,cov_2_0," \
       "cov_2_1,cov_2_2\n1,0.1,0,0,1,0,0,0,1,0,0,0,1\n2,0,0.1,0,1,0,0,0,1,0,0,0,1\n"
LOG_STUDY = """[study]
name = yard
runs = 1
[scenario]
kind = log
path = yard
[belief]
vehicle = differential_drive
sigma_speed = 0.1
sigma_yaw_rate_deg = 1
sigma_range = 0.1
sigma_bearing_deg = 1
[association]
kind = known
[cells]
cell = ekf_slam
"""
TEXTS = {
    "blink.ini": STUDY,
    "blink.csv": WORLD,
    "e_0.csv": POSE,
    "e_1.csv": POSE,
    "truth.csv": "time_s,x_m,y_m,heading_rad\n1,0,0,0\n2,0,0,0\n",
    "yard.ini": LOG_STUDY,
    "yard/odometry.csv": "time_s,speed_mps,yaw_rate_radps\n0,1,0\n1,1,0.1\n2,1,0\n",
    "yard/detections.csv": "time_s,range_m,bearing_rad,identity\n0.5,5,0.1,0\n1.5,4,0.2,0\n"
                           "1.5,6,-0.3,1\n",
    "yard/start.csv": "time_s,x_m,y_m,heading_rad\n0,0,0,0\n",
    "yard/reference.csv": "time_s,x_m,y_m,sigma_x_m,sigma_y_m\n0.5,0.5,0,0.1,0.1\n"
                          "1.5,1.5,0,0.1,0.1\n",
}
NUMBERS = ("1", "0.5", "3", "-2", "7e-3", "nan", "inf", "-inf", "1e308", "-1e308", "1e-320",
           "1e999", "-0", "", "0x10", "1,5", "99999999999999999999", "\x1b[2J", "a" * 3000,
           "\u20ac", "=", "#", '"')


def damaged(text, dice):
    for _ in range(dice.randint(1, 2)):
        lines, kind = text.split("\n"), dice.randrange(8)
        at = dice.randrange(len(lines))
        if kind == 0:
            lines.insert(at, lines[dice.randrange(len(lines))])
        elif kind == 1:
            del lines[at]
        elif kind == 2:
            other = dice.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif kind in (3, 4, 5):
            places = [match.span() for match in re.finditer(r"[\w.+-]+", text)]
            if places:
                begin, end = dice.choice(places)
                text = text[:begin] + dice.choice(NUMBERS) + text[end:]
            continue
        elif kind == 6:
            text = text[:dice.randrange(len(text) + 1)]
            continue
        text = "\n".join(lines)
    data = bytearray(text.encode())
    if dice.random() < 0.3 and data:
        for _ in range(dice.randint(1, 4)):
            data[dice.randrange(len(data))] = dice.randrange(256)
    if dice.random() < 0.05:
        data = bytearray(text.encode("utf-16"))
    return bytes(data)


def command_of(name, dice):
    judge = ["judge", "e_0.csv", "e_1.csv", "--truth", "truth.csv", "--error",
             dice.choice(("world", "body", "right-invariant")), "-o", "mine.h5"]
    if name.startswith(("e_", "truth")):
        return judge
    study = "yard.ini" if name.startswith("yard") else "blink.ini"
    return dice.choice((["check", study, "--text"], ["run", study, "-o", "out.h5", "--quiet"],
                        ["export", study, "-o", "drives"]))


class Ground:
    """Where a case runs; damaged_results.run() wants a folder and a program."""

    def __init__(self, folder, program):
        self.folder, self.program = folder, program
        (folder / "yard").mkdir(parents=True)
        for name, text in TEXTS.items():
            (folder / name).write_text(text)


def try_one(folder, program, seed):
    dice = random.Random(seed)
    ground = Ground(Path(folder) / f"case{seed}", program)
    name = dice.choice(list(TEXTS))
    (ground.folder / name).write_bytes(damaged(TEXTS[name], dice))
    words = command_of(name, dice)
    code, seconds, said = damaged_results.run(ground, words)
    fault = None
    named = code in (0, 3) or re.search(rb"\.(ini|csv|h5)|--", said)
    if code not in (0, 2, 3) or not named or b"internal error" in said or b"\x1b" in said \
            or len(said) > 100_000:
        kept = Path(tempfile.gettempdir()) / f"montecarta_damaged_text_{seed}"
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(ground.folder, kept)
        fault = f"{' '.join(words)}, {name}, seed {seed}: code {code}, {kept}\n    {said[-300:]!r}"
    shutil.rmtree(ground.folder)
    return words[0], code, seconds, fault


def main():
    program = str(Path(sys.argv[1]).resolve())
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 150
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    counts, slowest, faults = collections.Counter(), collections.Counter(), 0
    with tempfile.TemporaryDirectory(prefix="montecarta-damaged-") as folder:
        with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
            outcomes = pool.map(try_one, itertools.repeat(folder), itertools.repeat(program),
                                range(first, first + count))
            for name, code, seconds, fault in outcomes:
                counts[name, code] += 1
                slowest[name] = max(slowest[name], seconds)
                if fault:
                    faults += 1
                    print(fault, flush=True)
    for (name, code), number in sorted(counts.items()):
        print(f"{name:8} code {code:3}: {number:6}, slowest {slowest[name]:.2f} s")
    print(f"{count} damaged texts, {faults} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
