# SPDX-License-Identifier: BSD-3-Clause
"""The page as a whole: what opens, on which screen, and what it leaves alone."""

import chromium
from on_page import OPEN_ALL, OnPage


class Opening(OnPage):

    def test_takes_less_than_two_seconds(self):
        work = [self.open().work() for _ in range(3)]
        self.assertGreater(min(work), 0.01)
        self.assertLess(min(work), 2.0)

    def test_fits_every_screen(self):
        for width in (360, 800, 1400):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    self.page = self.open(width=width, dark=dark)
                    self.assertLessEqual(self.ask("html", "scrollWidth"), width)
                    self.page.evaluate(OPEN_ALL)
                    self.later(100)
                    self.assertLessEqual(self.ask("html", "scrollWidth"), width)
                    colour = self.page.evaluate("getComputedStyle(document.body).backgroundColor")
                    self.assertEqual(colour == "rgb(255, 255, 255)", not dark)
                    self.tearDown()

    def test_leaves_no_names_behind(self):
        names = "Object.getOwnPropertyNames(window)"
        before = self.open(scripts=False).evaluate(names)
        self.assertEqual(set(self.page.evaluate(names)) - set(before), set())

    def test_without_scripts_shows_the_drawings(self):
        shown = "[...document.querySelectorAll('svg.drawing')].map(e => e.clientHeight > 50)"
        self.assertIn(False, self.page.evaluate(shown))
        self.page = self.open(scripts=False)
        self.page.evaluate(OPEN_ALL)
        self.assertGreater(self.count("svg.drawing"), 3)
        self.assertNotIn(False, self.page.evaluate(shown))
        self.assertEqual(self.count("svg.chart"), 0)

    def test_same_file_same_page(self):
        again = self.html.parent.parent / "b/index.html"
        self.assertEqual(self.html.read_bytes(), again.read_bytes())
