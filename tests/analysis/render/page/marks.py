# SPDX-License-Identifier: BSD-3-Clause
"""Figures of marks at places of their own: maps, points and trees."""

from on_page import OnPage

MAP = "#figure_paths svg.chart"


class Maps(OnPage):

    def setUp(self):
        super().setUp()
        self.unfold("paths", "paths")

    def scales(self):
        """Pixels a metre of the first panel, across and upwards."""
        a, b = self.place_of("paths", 0, 0, 0), self.place_of("paths", 0, 1, 1)
        return b[0] - a[0], a[1] - b[1]

    def panels(self):
        return self.count(f"{MAP} g.panel:not([hidden])")

    def test_say_time_place_and_error_of_the_estimate(self):
        marks = {mark["name"]: mark for mark in self.chart("paths")["panels"][1]["marks"]}
        estimate = marks["estimate"]
        i = len(estimate["x"]) // 3
        self.page.hover(self.place_of("paths", 1, estimate["x"][i], estimate["y"][i]))
        title, facts = self.said("paths")
        self.assertIn(title, ("fastslam2_m20: estimate", "true path",
                              "fastslam2_m20: 2 sigma of the pose"))
        for axis in ("x", "y"):
            told = float(facts[axis].replace("−", "-").split()[0])
            self.assertAlmostEqual(told, estimate[axis][i], delta=0.5)
        self.page.hover(self.page.middle("h1"))
        self.assertIsNone(self.said("paths"))

    def test_keep_one_scale_while_they_are_zoomed_together(self):
        whole = self.scales()
        self.assertAlmostEqual(whole[0] / whole[1], 1, delta=0.01)
        begin, end = self.page.middle(MAP, 0.1, 0.3), self.page.middle(MAP, 0.2, 0.6)
        width, height = self.page.evaluate(f"""(() => {{
            const box = document.querySelector("{MAP} .frame").getBoundingClientRect();
            return [box.width, box.height];
        }})()""")
        self.page.drag(begin, end)
        near = self.scales()
        # All that was in the box is in view, and no more of its longer side.
        share = max((end[0] - begin[0]) / width, (end[1] - begin[1]) / height)
        self.assertAlmostEqual(near[0] / whole[0] * share, 1, delta=0.03)
        self.assertAlmostEqual(near[0] / near[1], 1, delta=0.02)
        self.page.click(self.page.middle(MAP), count=2)
        self.assertEqual(self.scales(), whole)

    def test_show_all_when_zoomed_out_far_enough(self):
        self.page.evaluate(f"document.querySelector('{MAP}').focus()")
        self.page.press("+")
        self.assertFalse(self.ask("#figure_paths .hint button", "hidden"))
        for _ in range(3):
            self.page.press("-")
        self.assertTrue(self.ask("#figure_paths .hint button", "hidden"))

    def test_leave_their_place_where_their_cell_is_hidden(self):
        self.assertEqual(self.panels(), 3)
        self.page.click(self.page.middle("#figure_paths .legend button[data-cell=ekf_slam]"))
        self.assertEqual(self.panels(), 2)
        self.assertEqual(self.count("#figure_anees svg.chart path.curve[data-cell=ekf_slam]"), 0)
        self.page.click(self.page.middle("#figure_paths .legend button[data-cell=ekf_slam]"))
        self.assertEqual(self.panels(), 3)


class Tree(OnPage):

    def setUp(self):
        super().setUp()
        self.unfold("diversity", "ancestry")

    def ends(self):
        return [float(self.ask("#figure_ancestry svg.chart", f"dataset.{end}"))
                for end in ("from", "to")]

    def test_begins_where_all_lines_have_met_and_shows_the_whole_run_when_asked(self):
        chart = self.chart("ancestry")
        self.assertEqual(self.ends(), [chart["x_first"], chart["x_to"]])
        self.assertGreater(chart["x_first"], 0)
        self.page.click(self.page.middle("#figure_ancestry .hint button"))
        self.assertEqual(self.ends(), [0, chart["x_to"]])

    def test_says_how_many_descend_from_a_line(self):
        chart = self.chart("ancestry")
        lines = chart["panels"][1]["marks"][0]
        leaves = lines["facts"][2]["values"]
        trunk = max(range(len(leaves)), key=lambda i: leaves[i] or 0)
        self.assertEqual(leaves[trunk], 20)
        end = next(i for i in range(trunk, len(leaves)) if leaves[i] is None) - 1
        before_its_fork = 0.5 * (chart["x_first"] + lines["x"][end])
        self.page.hover(self.place_of("ancestry", 1, before_its_fork, lines["y"][end]))
        title, facts = self.said("ancestry")
        self.assertEqual(title, "fastslam2_m20")
        self.assertEqual(facts["descendants at the end"], "20")
