# SPDX-License-Identifier: BSD-3-Clause
"""cluster/Snakefile on the cores of this machine, with a shard that is killed.

usage: snakemake_test.py MONTECARTA      (exit code 77, with the reason, where Snakemake is absent)
"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]

STUDY = """[study]
name = shards
runs = 12
[scenario]
world = dense_loop
loops = 1
[cells]
cell = ekf_slam
cell = fastslam2 particles=500
[record]
columns = pose
rate = scan
"""

# Kills the first attempt at shard 1 with -9 when it has begun its file.
KILLER = """#!/bin/bash
[[ " $* " == *" --shard 1/3 "* ]] && mkdir "{folder}/killed" 2>/dev/null || exec "{program}" "$@"
"{program}" "$@" &
while kill -0 $! && ! compgen -G "{folder}/out/shards/shard_0001.h5.part.*" >/dev/null; do
  sleep 0.01
done
kill -9 $!
wait $!
"""


class Snakemake(unittest.TestCase):
    program = ""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="montecarta-snakemake-"))
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "study.ini").write_text(STUDY)
        killer = self.folder / "killer"
        killer.write_text(KILLER.format(folder=self.folder, program=self.program))
        killer.chmod(0o755)

    def call(self, words, code=0):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        done = subprocess.run([str(word) for word in words], cwd=self.folder, env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout

    def snakemake(self, *config, code=0):
        words = ["snakemake", "-s", TOP / "cluster/Snakefile", "--cores", "2"]
        return self.call(words + (["--config", *config] if config else []), code)

    def test_a_killed_shard_is_continued_to_the_bits_of_one_machine(self):
        config = ("study=study.ini", "shards=3", "folder=out", f"program={self.folder}/killer")
        self.snakemake(*config)
        self.assertTrue((self.folder / "killed").is_dir(), "no shard was killed")
        self.call([self.program, "run", "study.ini", "-o", "one.h5", "--quiet"])
        for group in ("/cells", "/truth", "/scenario"):
            self.call(["h5diff", "out/result.h5", "one.h5", group, group])
        self.assertIn("ekf_slam", (self.folder / "out/verdict.txt").read_text())
        self.assertEqual([], list((self.folder / "out/shards").glob("*.part*")))
        self.assertIn("Nothing to be done", self.snakemake(*config))

    def test_what_is_missing_is_named(self):
        self.assertIn("shards is missing", self.snakemake("study=study.ini", code=1))
        absent = self.snakemake("study=study.ini", "shards=3", "program=./absent", code=1)
        self.assertIn("./absent: not found: build montecarta", absent)


if __name__ == "__main__":
    absent = [name for name in ("snakemake", "h5diff") if shutil.which(name) is None]
    if absent:
        print(f"skipped: not installed: {', '.join(absent)}")
        sys.exit(77)
    Snakemake.program = str(Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=2)
