# SPDX-License-Identifier: BSD-3-Clause
"""A report of a small study, opened in a browser once for each test."""

import json
import pathlib
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
# Nine cells: more than a figure over time draws as curves.
STRIPS = """[study]
name = strips
runs = 40
[scenario]
world = inline
noise = matched
speed = 2
control_rate = 10
scan_rate = 5
wheelbase = 1
steer_rate_limit_deg = 90
[cells]
cell = ekf_slam motion_noise=1,2,4 sensor_noise=1,2,4
[record]
columns = pose, covariance, final_map
[world]
waypoint = 10, 0
waypoint = 10, 10
waypoint = 0, 10
waypoint = 0, 0
landmark = 5, 3
landmark = 13, 5
landmark = 6, 13
landmark = -3, 6
"""
OPEN_ALL = "for (const one of document.querySelectorAll('details')) one.open = true"
FIRST_STUDY = pathlib.Path(__file__).parents[4] / "experiments/studies/first_study.ini"
CTRL, SHIFT = 2, 8  # modifiers of a key or click


def make_report(montecarta, folder, text=STUDY):
    """Runs a small study and returns its report's page."""
    folder.mkdir(exist_ok=True)
    study, result = folder / "study.ini", folder / "out.h5"
    study.write_text(text)
    for command in (["run", study, "-o", result, "--quiet"], ["report", result, "-o", folder / "a"],
                    ["report", result, "-o", folder / "b"]):
        subprocess.run([montecarta, *command], check=True, stdout=subprocess.DEVNULL)
    return (folder / "a" / "index.html").resolve()


class OnPage(unittest.TestCase):
    """A test that must leave the console empty and the network alone."""

    reports = {}  # {study: its page}
    study = "page"
    screen = {}

    @classmethod
    def setUpClass(cls):
        cls.browser = chromium.Browser()
        cls.addClassCleanup(cls.browser.close)
        cls.html = cls.reports[cls.study]

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

    def unfold(self, section, figure):
        """Opens a section as a reader does, and waits for its figure."""
        self.page.click(self.page.middle(f"#{section} > .folded > summary h2"))
        self.wait_for(f"document.querySelector('#figure_{figure} svg.chart') !== null")

    def place_of(self, figure, panel, x, y):
        """Where a panel of a chart has its values (x, y), in pixels of the window."""
        self.page.middle(f"#figure_{figure} svg.chart")
        return self.page.evaluate(f"""(() => {{
            const svg = document.querySelector("#figure_{figure} svg.chart");
            const group = svg.querySelectorAll("g.panel")[{panel}];
            const box = svg.getBoundingClientRect();
            const along = (name, attribute, wanted) => {{
                const ticks = [...group.querySelectorAll(`.${{name}}.tick`)].map(tick =>
                    [Number(tick.textContent.replace("−", "-")),
                     Number(tick.getAttribute(attribute))]);
                const [[a, at_a], [b, at_b]] = [ticks[0], ticks.at(-1)];
                return at_a + (wanted - a) / (b - a) * (at_b - at_a);
            }};
            return [box.left + along("x", "x", {x}), box.top + along("y", "y", {y}) - 4];
        }})()""")

    def said(self, figure):
        """(title, {name: text}) of a figure's readout, as it stands there; None where none is."""
        return self.page.evaluate(f"""(() => {{
            const box = document.querySelector("#figure_{figure} .readout");
            if (box.hidden) return null;
            return [box.firstChild.textContent, Object.fromEntries(
                [...box.querySelectorAll("tr")].map(row =>
                    [...row.cells].map(c => c.textContent)))];
        }})()""")

    def chart(self, figure):
        return json.loads(self.ask(f"#figure_{figure} .chart-data", "textContent"))

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
