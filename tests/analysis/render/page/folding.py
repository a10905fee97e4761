# SPDX-License-Identifier: BSD-3-Clause
"""Sections that are folded, explanations that are asked for, and the cards above them."""

from on_page import OPEN_ALL, OnPage

FOLDED = "#diversity > .folded"


class Folding(OnPage):

    def test_draws_a_figure_when_its_section_is_opened(self):
        self.assertEqual(self.count("#figure_ess svg.chart"), 0)
        self.unfold("diversity", "ess")
        width = self.ask("#figure_ess", "clientWidth")
        self.assertGreater(width, 600)
        self.assertEqual(self.ask("#figure_ess svg.chart", "clientWidth"), width)

    def test_keeps_a_cell_hidden_in_figures_that_are_opened_later(self):
        self.page.click(self.page.middle("#figure_anees .legend button[data-cell=fastslam2_m10]"))
        self.unfold("diversity", "ess")
        button = "#figure_ess .legend button[data-cell=fastslam2_m10]"
        self.assertEqual(self.ask(button, "getAttribute('aria-pressed')"), "false")
        self.assertEqual(self.count("#figure_ess path.curve[data-cell=fastslam2_m10]"), 0)
        self.assertEqual(self.count("#figure_ess path.curve[data-cell=fastslam2_m20]"), 1)

    def test_opens_what_a_link_leads_to(self):
        for target in ("diversity", "figure_ess"):
            with self.subTest(target=target):
                self.page.evaluate(f"document.querySelector('{FOLDED}').open = false")
                self.page.evaluate(f"location.hash = '{target}'")
                self.wait_for(f"document.querySelector('{FOLDED}').open")
        self.page.evaluate("location.hash = ''")

    def test_opens_and_closes_by_keys(self):
        for selector in (FOLDED, "#cards .card .why"):
            with self.subTest(selector=selector):
                self.page.evaluate(f"document.querySelector('{selector} > summary').focus()")
                for is_open in ("true", "false"):
                    self.page.press(" ", "Space")
                    self.wait_for(f"document.querySelector('{selector}').open === {is_open}")

    def test_prints_all_sections(self):
        opened = self.count("details[open]")
        self.page.evaluate("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.count("details.folded:not([open])"), 0)
        self.assertEqual(self.count("section > details.why:not([open])"), 0)
        self.assertEqual(self.count(".card details[open]"), 0)
        self.page.evaluate("dispatchEvent(new Event('afterprint'))")
        self.assertEqual(self.count("details[open]"), opened)


class Cards(OnPage):

    screen = {"width": 390, "height": 800}

    def test_stand_below_each_other_on_a_narrow_page(self):
        lefts = self.page.evaluate("""[...document.querySelectorAll(".card")].map(card =>
            card.getBoundingClientRect().left)""")
        self.assertEqual(len(lefts), 3)
        self.assertEqual(len(set(lefts)), 1)

    def test_nothing_but_tables_that_say_so_scrolls_sideways(self):
        self.page.evaluate(OPEN_ALL)
        self.later()
        scrolling = """[...document.querySelectorAll("body *")].filter(one =>
            one.scrollWidth > one.clientWidth + 1 && one.clientWidth > 0
            && getComputedStyle(one).overflowX === "auto")"""
        self.assertGreater(self.page.evaluate(f"{scrolling}.length"), 0)
        self.assertEqual(self.page.evaluate(
            f"{scrolling}.filter(one => !one.matches('.scrolls[tabindex]')).length"), 0)
