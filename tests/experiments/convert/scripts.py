# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of experiments/convert share: files of our own making, and calls of the scripts.

Ends the test with 77 where SciPy is not installed, which ctest shows as skipped.
"""
import bisect
import contextlib
import io
import os
import sys
import tempfile
import types
import unittest

try:
    import numpy as np
    from scipy.io import savemat
except ImportError:
    print("skipped: python3-scipy is not installed (bash .ci/install-packages convert)")
    sys.exit(77)

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../..")
sys.path.insert(0, os.path.join(SOURCE, "experiments/convert"))
import conversion  # noqa: E402


def sweep_of(*surfaces):
    """A sweep in which nothing comes back, but for surfaces (first beam, last beam, range)."""
    ranges = np.full(conversion.LASER_BEAMS, 81.91)
    for first, last, distance in surfaces:
        ranges[first:last + 1] = distance
    return ranges


def path_of(start, odometry, times):
    """The poses {time, (x, y, heading)} at some times, all after the start (time, x, y, heading),
    of rows (time, speed, yaw rate) or (time, forward, left, yaw rate), each of which holds until
    the next one. In steps of a millisecond, so that it shares nothing with a converter."""
    now, x, y, heading = start
    begins, poses = [row[0] for row in odometry], []
    for time in times:
        steps = max(1, round((time - now) / 1e-3))
        for k in range(steps):
            middle = now + (k + 0.5) * (time - now) / steps
            held = bisect.bisect_right(begins, middle) - 1
            if held < 0:  # it stands still before the first row
                continue
            row = odometry[held]
            forward, left = row[1], row[2] if len(row) == 4 else 0.0
            step = (time - now) / steps
            bow = heading + row[-1] * step / 2
            x += step * (forward * np.cos(bow) - left * np.sin(bow))
            y += step * (forward * np.sin(bow) + left * np.cos(bow))
            heading += row[-1] * step
        now = time
        poses.append((x, y, heading))
    return np.array(poses)


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def save(self, name, variables):
        savemat(self.path(name), variables)

    def rows(self, *names):
        """Fields of a CSV file, row by row, behind its header."""
        with open(self.path(*names), encoding="utf-8") as file:
            return [line.rstrip("\n").split(",") for line in file][1:]

    def bytes_of(self, *names):
        """{path below a folder: bytes} of all its files."""
        found = {}
        for folder, _, files in os.walk(self.path(*names)):
            for name in files:
                with open(os.path.join(folder, name), "rb") as file:
                    found[os.path.relpath(file.name, self.path(*names))] = file.read()
        return found

    def expect_same_bytes_twice(self, script, **arguments):
        """Two conversions write the same bytes, and none into a folder that holds something."""
        for name in ("once", "twice"):
            self.converted(script, **{**arguments, "output": self.path(name)})
        self.assertEqual(self.bytes_of("once"), self.bytes_of("twice"))
        self.assertTrue(self.bytes_of("once"))
        with self.assertRaisesRegex(conversion.ConversionError, "nothing is overwritten|not empty"):
            self.converted(script, **{**arguments, "output": self.path("once")})

    def converted(self, script, **arguments):
        """Runs a script's convert() and returns what it printed."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
            script.convert(types.SimpleNamespace(**arguments))
        return printed.getvalue()

    def numbers(self, *names):
        """The rows of a CSV file as numbers; an empty field is None."""
        return [[float(field) if field else None for field in row] for row in self.rows(*names)]

    def expect_refused(self, script, pieces, **arguments):
        """The complaint names all pieces, in this order, and nothing is written."""
        with self.assertRaises(conversion.ConversionError) as caught:
            self.converted(script, **arguments)
        said, at = str(caught.exception), 0
        for piece in pieces:
            self.assertIn(piece, said[at:])
            at = said.index(piece, at) + len(piece)
        if "output" in arguments:
            self.assertFalse(os.path.exists(arguments["output"]), said)
