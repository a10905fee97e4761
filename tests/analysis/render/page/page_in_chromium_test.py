#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A report's page in a real browser: it opens quietly and alone, and everything on it works.

usage: page_in_chromium_test.py MONTECARTA [TEST...]
Exit code 77: skipped, since there is no Chromium.
"""

import pathlib
import sys
import tempfile
import unittest

import chromium
from figures import Hover, Legend, Touch, Zoom  # noqa: F401: found by unittest
from figures import Strips, StripsOnAPhone  # noqa: F401
from figures import BoxesAndSweeps, BoxesAndSweepsOnAPhone  # noqa: F401
from folding import Cards, Folding  # noqa: F401
from marks import Maps, Tree  # noqa: F401
from on_page import FIRST_STUDY, STRIPS, STUDY, OnPage, make_report  # noqa: F401
from opening import Opening  # noqa: F401
from player import FirstStudy, Player  # noqa: F401

if __name__ == "__main__":
    if chromium.find() is None:
        print("skipped: there is no chromium (Debian package 'chromium'), so no page was opened")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="montecarta_page_") as folder:
        montecarta = sys.argv.pop(1)
        for name, text in (("page", STUDY), ("strips", STRIPS),
                           ("first", FIRST_STUDY.read_text())):
            OnPage.reports[name] = make_report(montecarta, pathlib.Path(folder) / name, text)
        unittest.main(verbosity=2)
