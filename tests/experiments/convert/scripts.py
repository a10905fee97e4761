# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of experiments/convert share: files of our own making, and calls of the scripts.

Ends the test with 77 where SciPy is not installed, which ctest shows as skipped.
"""
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

    def converted(self, script, **arguments):
        """Runs a script's convert() quietly."""
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            script.convert(types.SimpleNamespace(**arguments))

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
