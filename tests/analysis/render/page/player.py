# SPDX-License-Identifier: BSD-3-Clause
"""The player of a stored run."""

import json

from on_page import CTRL, OnPage


class Player(OnPage):

    def clock(self):
        return float(self.ask(".player .clock", "textContent").split()[0])

    def picture(self):
        return self.ask(".player canvas", "toDataURL()")

    def wait_for_another_picture(self, before):
        self.wait_for("document.querySelector('.player canvas').toDataURL() !== "
                      f"{json.dumps(before)}")

    def focus(self):
        self.page.evaluate("document.querySelector('.player canvas').focus()")

    def test_plays_and_pauses(self):
        first, play = self.picture(), self.page.middle(".player .play")
        self.page.click(play)
        self.wait_for("parseFloat(document.querySelector('.player .clock').textContent) > 5")
        self.assertNotEqual(self.picture(), first)
        self.page.click(play)
        begin, still = self.clock(), self.picture()
        self.later()
        self.assertEqual((self.clock(), self.picture()), (begin, still))

    def test_stops_at_the_end_and_begins_anew(self):
        self.focus()
        self.page.press("End")
        self.page.press("ArrowLeft")
        self.page.press(" ", "Space")
        self.wait_for("document.querySelector('.player .play').textContent === 'Play'")
        self.assertGreater(self.clock(), 200)
        # Pressed and read at one moment: the clock of a page on a busy machine may jump.
        self.assertLess(self.page.evaluate("""(() => {
            const press = new KeyboardEvent("keydown", {key: " ", bubbles: true});
            document.querySelector(".player canvas").dispatchEvent(press);
            return parseFloat(document.querySelector(".player .clock").textContent);
        })()"""), 100)

    def test_is_scrubbed(self):
        first = self.picture()
        self.page.click(self.page.middle(".player input[type=range]", x=0.8))
        self.assertGreater(self.clock(), 100)
        self.assertNotEqual(self.picture(), first)

    def test_obeys_keys(self):
        self.assertGreater(self.clock(), 200)  # all of the run is seen at first
        self.focus()
        self.page.press("Home")
        self.page.press("ArrowRight")
        step = self.clock()
        self.page.press("ArrowRight")
        self.assertGreater(self.clock(), step)
        self.page.press("ArrowLeft")
        self.assertEqual(self.clock(), step)
        self.page.press(" ", "Space")
        self.wait_for(f"parseFloat(document.querySelector('.player .clock').textContent) > {step}")

    def cells(self):
        return self.page.evaluate("[...document.querySelectorAll('.player .panel')]"
                                  ".filter(e => !e.hidden).map(e => e.dataset.cell)")

    def pictures(self, kind):
        return self.page.evaluate(f"[...document.querySelectorAll('.player canvas.{kind}')]"
                                  ".map(e => e.toDataURL())")

    def test_shows_all_cells_on_one_clock(self):
        self.assertEqual(self.cells(), ["fastslam2_m10", "fastslam2_m20", "ekf_slam"])
        for kind in ("scene", "close", "growth"):
            before = self.pictures(kind)
            self.assertEqual(len(set(before)), 3, kind)
            self.page.click(self.page.middle(".player input[type=range]", x=0.6))
            after = self.pictures(kind)
            self.assertEqual([a == b for a, b in zip(before, after)], [False] * 3, kind)
            self.focus()
            self.page.press("Home")

    def test_switches_cells_but_never_the_last(self):
        for cell in ("fastslam2_m10", "ekf_slam", "fastslam2_m20"):
            self.page.click(self.page.middle(f".player .legend button[data-cell={cell}]"))
        self.assertEqual(self.cells(), ["fastslam2_m20"])
        self.page.click(self.page.middle(".player .legend button[data-cell=ekf_slam]"))
        self.assertEqual(self.cells(), ["fastslam2_m20", "ekf_slam"])

    def test_says_the_nees_of_the_moment(self):
        nees = self.page.evaluate("JSON.parse(document.querySelector('.replay-data')"
                                  ".textContent).cells.map(cell => cell.nees)")
        self.focus()
        self.page.press("End")
        said = self.page.evaluate("[...document.querySelectorAll('.player .head .soft')]"
                                  ".map(e => e.textContent)")
        for text, values in zip(said, nees):
            ratio = float(text.removeprefix("this run: NEES ratio "))
            self.assertAlmostEqual(ratio / values[-1], 1, delta=0.01)

    def test_panels_stand_below_each_other_on_a_phone(self):
        places = ("[...document.querySelectorAll('.player .panel')]"
                  ".map(e => { const box = e.getBoundingClientRect(); return [box.x, box.y]; })")
        beside = self.page.evaluate(places)
        self.assertEqual(len({y for _, y in beside}), 1)
        self.page = self.open(width=390)
        below = self.page.evaluate(places)
        self.assertEqual([len({x for x, _ in below}), len({y for _, y in below})], [1, 3])
        self.assertLessEqual(self.ask("html", "scrollWidth"), 390)

    def test_is_on_paper_in_its_proportions(self):
        self.page.call("Emulation.setEmulatedMedia", media="print")
        self.later()
        shapes = self.page.evaluate("""[...document.querySelectorAll(".player canvas")].map(one =>
            one.clientWidth / one.clientHeight * one.height / one.width)""")
        self.assertEqual(len(shapes), 9)
        for shape in shapes:
            self.assertAlmostEqual(shape, 1, delta=0.03)

    def test_every_layer_is_another_picture(self):
        self.page.click(self.page.middle(".player input[type=range]", x=0.6))
        seen = [self.picture()]
        for layer in ("follow", "truth", "ellipse", "particles", "ancestry", "map"):
            self.page.click(self.page.middle(f".player input[name={layer}]"))
            seen.append(self.picture())
        self.assertEqual(len(set(seen)), len(seen))

    def test_is_zoomed_and_moved_like_a_map(self):
        seen, middle = [self.picture()], self.page.middle(".player canvas")
        self.page.wheel(middle, -300, CTRL)
        self.wait_for_another_picture(seen[0])
        seen.append(self.picture())
        self.page.drag(middle, (middle[0] + 60, middle[1] + 40))
        seen.append(self.picture())
        self.assertEqual(len(set(seen)), 3)
        self.page.click(middle, count=2)
        self.assertEqual(self.picture(), seen[0])


class FirstStudy(OnPage):
    """The replay that a newcomer sees first."""

    study = "first"

    def test_is_small_enough_to_be_sent(self):
        self.assertLess(self.html.stat().st_size, 2e6)
        runs = 50  # of three filters, one run in full
        self.assertLess((self.html.parent.parent / "out.h5").stat().st_size / runs, 1.3e6)

    def test_has_particles_ancestry_and_maps_of_one_run(self):
        shown = self.page.evaluate("""JSON.parse(document.querySelector('.replay-data').textContent)
            .cells.map(cell => [cell.clouds.length > 0, cell.ancestry, cell.maps.length > 0])""")
        self.assertEqual(shown, [[False, False, True], [True, True, True], [True, True, True]])

    def test_has_a_still(self):
        still = (self.html.parent / "figures/replay.svg").read_text()
        self.assertEqual(still.count("<svg"), 1 + 2 * 3)
