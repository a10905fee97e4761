# SPDX-License-Identifier: BSD-3-Clause
"""Figures that are zoomed into, asked and thinned out."""

from on_page import CTRL, SHIFT, OnPage

CHART = "#figure_anees svg.chart"


class Legend(OnPage):

    def button(self, figure, cell):
        return f"#figure_{figure} .legend button[data-cell={cell}]"

    def curves(self, figure, cell):
        return self.count(f"#figure_{figure} svg.chart path.curve[data-cell={cell}]")

    def press(self, figure, cell, modifiers=0):
        self.page.click(self.page.middle(self.button(figure, cell)), modifiers=modifiers)

    def test_hides_a_cell_everywhere_and_shows_it_again(self):
        self.assertEqual(self.curves("anees", "ekf_slam"), 1)
        self.press("anees", "ekf_slam")
        self.assertEqual([self.curves(figure, "ekf_slam") for figure in ("anees", "rmse")], [0, 0])
        self.assertEqual(self.curves("anees", "fastslam2_m10"), 1)
        self.press("rmse", "ekf_slam")
        self.assertEqual([self.curves(figure, "ekf_slam") for figure in ("anees", "rmse")], [1, 2])

    def test_hides_a_cell_in_one_figure_where_that_is_wanted(self):
        self.page.click(self.page.middle("#figure_anees .legend input"))
        self.press("anees", "ekf_slam")
        self.assertEqual([self.curves(figure, "ekf_slam") for figure in ("anees", "rmse")], [0, 2])

    def test_shows_one_cell_alone(self):
        self.press("anees", "ekf_slam", SHIFT)
        self.assertEqual(self.curves("anees", "ekf_slam"), 1)
        self.assertEqual(self.curves("anees", "fastslam2_m10"), 0)

    def test_hides_the_envelopes_of_a_cell_with_its_panels(self):
        shown = "#figure_error_envelopes g.panel:not([hidden]) path.envelope"
        self.assertEqual(self.count(shown + "[data-cell=ekf_slam]"), 3)
        others = self.count(shown) - 3
        self.press("error_envelopes", "ekf_slam")
        self.assertEqual(self.count(shown), others)
        self.assertEqual(self.count(shown + "[data-cell=ekf_slam]"), 0)


class Zoom(OnPage):

    def times(self):
        return [float(self.ask(CHART, f"dataset.{end}")) for end in ("from", "to")]

    def ticks(self):
        return self.page.evaluate(f"[...document.querySelectorAll('{CHART} .tick')]"
                                  ".map(e => e.textContent)")

    def test_by_a_box_and_back_by_a_double_click(self):
        whole, ticks = self.times(), self.ticks()
        self.page.drag(self.page.middle(CHART, 0.3, 0.3), self.page.middle(CHART, 0.5, 0.6))
        begin, end = self.times()
        self.assertGreater(begin, whole[0] + 10)
        self.assertLess(end, whole[1] - 10)
        self.assertNotEqual(self.ticks(), ticks)
        self.page.click(self.page.middle(CHART), count=2)
        self.assertEqual((self.times(), self.ticks()), (whole, ticks))

    def test_by_the_wheel_only_when_it_is_meant(self):
        whole = self.times()
        self.page.wheel(self.page.middle(CHART), -300)
        self.later()  # the page scrolls
        self.assertEqual(self.times(), whole)
        self.page.wheel(self.page.middle(CHART), -300, CTRL)
        self.wait_for(f"Number(document.querySelector('{CHART}').dataset.from) > 0")

    def test_by_keys(self):
        self.page.evaluate(f"document.querySelector('{CHART}').focus()")
        self.page.press("+")
        self.assertGreater(self.times()[0], 0)
        begin = self.times()[0]
        self.page.press("ArrowLeft")
        self.assertLess(self.times()[0], begin)
        self.page.press("Escape")
        self.assertEqual(self.times()[0], 0)


class Hover(OnPage):

    def time_at(self, place):
        """What the axis says below a place."""
        left, width = self.page.evaluate(f"""(() => {{
            const box = document.querySelector("{CHART} .frame").getBoundingClientRect();
            return [box.left, box.width];
        }})()""")
        return float(self.ask(CHART, "dataset.to")) * (place[0] - left) / width

    def expect_true_values(self, place):
        time, values = self.said("anees")
        panel, wanted = self.chart("anees")["panels"][0], self.time_at(place)
        i = min(range(len(panel["x"])), key=lambda k: abs(panel["x"][k] - wanted))
        self.assertAlmostEqual(float(time.removeprefix("time ").removesuffix(" s")), panel["x"][i],
                               delta=0.006)
        self.assertEqual(set(values), {"ekf_slam", "fastslam2_m10", "fastslam2_m20"})
        for curve in panel["curves"]:
            self.assertAlmostEqual(float(values[curve["legend"]]) / curve["y"][i], 1, delta=1e-3)

    def test_says_the_values_at_the_pointer(self):
        self.assertIsNone(self.said("anees"))
        seen = []
        for x in (0.31, 0.36, 0.42, 0.47, 0.53, 0.58, 0.64, 0.69, 0.75):
            place = self.page.middle(CHART, x, 0.4)
            self.page.hover(place)
            self.expect_true_values(place)
            seen.append(self.said("anees")[0])
        self.assertEqual(len(set(seen)), len(seen))
        self.page.hover(self.page.middle("h1"))
        self.assertIsNone(self.said("anees"))


class Touch(Hover):

    screen = {"width": 360, "height": 740, "touch": True}

    def test_says_the_values_at_the_pointer(self):
        place = self.page.middle(CHART, 0.6, 0.4)
        self.page.touch("touchStart", [place])
        self.expect_true_values(place)
        self.page.touch("touchEnd", [])

    def test_two_fingers_zoom(self):
        left, right = self.page.middle(CHART, 0.4, 0.4), self.page.middle(CHART, 0.6, 0.4)
        self.page.touch("touchStart", [left, right])
        self.page.touch("touchMove", [(left[0] - 50, left[1]), (right[0] + 50, right[1])])
        self.page.touch("touchEnd", [])
        self.wait_for(f"Number(document.querySelector('{CHART}').dataset.from) > 5")


class Strips(OnPage):

    study = "strips"
    names_stand_above = False

    def place_of_strip(self, row, share):
        """A place in a strip, at a share of its length."""
        self.page.middle(CHART)
        return self.page.evaluate(f"""(() => {{
            const box = document.querySelectorAll("{CHART} g.strips")[{row}]
                .getBoundingClientRect();
            return [box.left + {share} * box.width, (box.top + box.bottom) / 2];
        }})()""")

    def test_say_filter_time_and_ratio(self):
        chart = self.chart("anees")
        panel = chart["panels"][0]
        rows = panel["strips"]["rows"]
        self.assertEqual(len(rows), 9)
        for r, share in ((0, 0.2), (4, 0.5), (8, 0.9)):
            self.page.hover(self.place_of_strip(r, share))
            title, facts = self.said("anees")
            self.assertEqual(title, rows[r]["name"])
            time = float(facts["time"].removesuffix(" s"))
            self.assertAlmostEqual(time / chart["x_to"], share, delta=0.01)
            column = max(k for k, begin in enumerate(panel["x"]) if begin <= time)
            self.assertIn(float(facts[panel["label"]]), rows[r]["ratios"][column - 1:column + 2])
        self.page.hover(self.page.middle("h1"))
        self.assertIsNone(self.said("anees"))

    def test_cut_no_name_and_cover_none(self):
        chart = self.page.evaluate(f"""(() => {{
            const box = element => {{
                const {{left, right, top, bottom}} = element.getBoundingClientRect();
                return [left, right, top, bottom];
            }};
            const all = what => [...document.querySelectorAll("{CHART} " + what)].map(box);
            return [box(document.querySelector("{CHART}")), all("text"), all("g.strips"),
                    all("text.row")];
        }})()""")
        (left, right, *_), texts, strips, names = chart
        self.assertEqual(len(strips), 9)
        for a, b, top, bottom in texts:
            self.assertGreaterEqual(a, left)
            self.assertLessEqual(b, right)
            for begin, end, high, low in strips:
                is_beside = b <= begin or a >= end or bottom <= high + 3 or top >= low - 3
                self.assertTrue(is_beside, "a text covers a strip")
        self.assertEqual(names[0][3] <= strips[0][2] + 3, self.names_stand_above)

    def test_cut_no_name_of_a_second_panel(self):
        self.unfold("consistency", "anees_parts")
        inside = self.page.evaluate("""(() => {
            const chart = document.querySelector("#figure_anees_parts svg.chart");
            const {left, right} = chart.getBoundingClientRect();
            return [...chart.querySelectorAll("text.row")].map(one => one.getBoundingClientRect())
                .map(box => box.left >= left - 1 && box.right <= right + 1);
        })()""")
        self.assertEqual(inside, [True] * 2 * 2 * 9)

    def test_zoom_in_time_alone(self):
        self.page.drag(self.place_of_strip(1, 0.4), self.place_of_strip(6, 0.6))
        self.assertGreater(float(self.ask(CHART, "dataset.from")), 0)
        self.assertEqual(self.count(f"{CHART} g.strips"), 9)


class StripsOnAPhone(Strips):

    screen = {"width": 390, "height": 740}
    names_stand_above = True


class BoxesAndSweeps(OnPage):

    study = "strips"  # it varies two options
    names_stand_above = False
    sweep = "sweep_motion_noise"

    def texts(self, figure, kind):
        return self.page.evaluate(f"[...document.querySelectorAll('#figure_{figure} svg.chart "
                                  f"{kind}')].map(e => e.textContent)")

    def test_name_the_rows_inside_the_chart(self):
        chart = self.chart("position_boxes")
        self.assertEqual(self.texts("position_boxes", "text.row"), chart["panels"][0]["names"])
        self.assertEqual(len(chart["panels"][0]["names"]), 9)
        inside, above = self.page.evaluate("""(() => {
            const chart = document.querySelector("#figure_position_boxes svg.chart");
            const {left, right} = chart.getBoundingClientRect();
            const names = [...chart.querySelectorAll("text.row")]
                .map(one => one.getBoundingClientRect());
            const box = chart.querySelector("g.marks").getBoundingClientRect();
            return [names.every(name => name.left >= left - 1 && name.right <= right + 1),
                    names[0].bottom <= box.top + 4];
        })()""")
        self.assertTrue(inside)
        self.assertEqual(above, self.names_stand_above)

    def test_say_the_quantiles(self):
        marks = self.chart("position_boxes")["panels"][0]["marks"]
        self.page.middle("#figure_position_boxes svg.chart")
        place = self.page.evaluate("""(() => {
            const median = document.querySelectorAll("#figure_position_boxes g.marks")[1];
            const box = median.getBoundingClientRect();
            return [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
        })()""")
        self.page.hover(place)
        title, facts = self.said("position_boxes")
        self.assertEqual(title, marks[0]["legend"])
        self.assertEqual(list(facts), ["5 %", "25 %", "median", "75 %", "95 %"])
        self.assertAlmostEqual(float(facts["median"].removesuffix(" m")), marks[1]["x"][0],
                               delta=1e-3)

    def test_show_every_value_of_the_option(self):
        chart = self.chart(self.sweep)
        self.assertEqual(chart["x_names"], ["1", "2", "4"])
        self.assertEqual(set(self.texts(self.sweep, "text.x.tick")), {"1", "2", "4"})
        self.assertEqual(self.count(f"#figure_{self.sweep} .legend button"), 3)

    def test_say_a_value_with_its_interval(self):
        self.page.middle(f"#figure_{self.sweep} svg.chart")
        place = self.page.evaluate(f"""(() => {{
            const chart = document.querySelector("#figure_{self.sweep} svg.chart");
            const {{left, top}} = chart.getBoundingClientRect();
            const first = chart.querySelector("path.dots").getAttribute("d");
            const [, x, y] = /^M([0-9.]+) ([0-9.]+)/.exec(first).map(Number);
            return [left + x, top + y];
        }})()""")
        self.page.hover(place)
        points = self.chart(self.sweep)["panels"][0]["marks"][2]
        title, facts = self.said(self.sweep)
        self.assertEqual(title, points["legend"])
        self.assertAlmostEqual(float(facts["lower end"]), points["facts"][1]["values"][0],
                               delta=1e-3)


class BoxesAndSweepsOnAPhone(BoxesAndSweeps):

    screen = {"width": 390, "height": 740}
    names_stand_above = True
