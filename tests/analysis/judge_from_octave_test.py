#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays that Octave saves, as the document has it: judge_from_octave_test.py PROGRAM."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from documented_examples import example

if shutil.which("octave") is None:
    print("skipped: octave is not installed (bash .ci/install-packages test)")
    sys.exit(77)

PROGRAM = os.path.abspath(sys.argv.pop(1))


class JudgeFromOctave(unittest.TestCase):
    def test_finds_a_kalman_filter_consistent_and_one_that_claims_less_not(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "filter.m"), "w", encoding="utf-8") as file:
                file.write(example("The same filter in Octave:"))
            path = os.path.dirname(PROGRAM) + os.pathsep + os.environ["PATH"]
            done = subprocess.run(["octave", "--no-gui", "--norc", "filter.m"], cwd=folder,
                                  env=os.environ | {"PATH": path}, check=True,
                                  capture_output=True, text=True)
            answers = [subprocess.run([PROGRAM, "gate", os.path.join(folder, name)], check=False,
                                      capture_output=True).returncode
                       for name in ("right.h5", "wrong.h5")]
        self.assertEqual(answers, [0, 4], done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
