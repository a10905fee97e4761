# SPDX-License-Identifier: BSD-3-Clause
"""A report of a small study, opened in a browser once for each test."""

import json
import subprocess
import unittest

import chromium

STUDY = """[study]
name = page
seed = 7
runs = 2
[scenario]
world = web_loop
noise = matched
sigma_speed = 0.3
sigma_steer_deg = 3
sigma_range = 0.1
sigma_bearing_deg = 1
[association]
kind = known
[cells]
cell = fastslam2 particles=10,20
cell = ekf_slam
[record]
columns = pose, covariance, ancestry, particles, map
"""
CTRL, SHIFT = 2, 8  # modifiers of a key or click


def make_report(montecarta, folder):
    """Runs a small study and returns its report's page."""
    study, result = folder / "study.ini", folder / "out.h5"
    study.write_text(STUDY)
    for command in (["run", study, "-o", result, "--quiet"], ["report", result, "-o", folder / "a"],
                    ["report", result, "-o", folder / "b"]):
        subprocess.run([montecarta, *command], check=True, stdout=subprocess.DEVNULL)
    return (folder / "a" / "index.html").resolve()


class OnPage(unittest.TestCase):
    """A test that must leave the console empty and the network alone."""

    html = None  # the page that is opened
    screen = {}

    @classmethod
    def setUpClass(cls):
        cls.browser = chromium.Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.page = self.open()

    def open(self, **screen):
        page = chromium.Page(self.browser, **{**self.screen, **screen})
        page.open(self.html)
        return page

    def tearDown(self):
        self.assertEqual(self.page.complaints_of_console(), [])
        self.assertEqual(self.page.requested(), [self.html.as_uri()])

    def ask(self, selector, what):
        return self.page.evaluate(f"document.querySelector({json.dumps(selector)}).{what}")

    def count(self, selector):
        return self.page.evaluate(f"document.querySelectorAll({json.dumps(selector)}).length")

    def later(self, milliseconds=300):
        self.page.evaluate(f"new Promise(done => setTimeout(done, {milliseconds}))")

    def wait_for(self, condition):
        """Until an expression is true in the page, or two minutes have passed."""
        self.assertTrue(self.page.evaluate(f"""(async () => {{
            const end = performance.now() + 120000;
            while (!({condition}) && performance.now() < end)
                await new Promise(done => setTimeout(done, 20));
            return {condition};
        }})()"""), condition)
