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
        self.focus()
        self.page.press("ArrowRight")
        step = self.clock()
        self.page.press("ArrowRight")
        self.assertGreater(self.clock(), step)
        self.page.press("ArrowLeft")
        self.assertEqual(self.clock(), step)
        self.page.press(" ", "Space")
        self.wait_for(f"parseFloat(document.querySelector('.player .clock').textContent) > {step}")

    def test_every_layer_and_cell_is_another_picture(self):
        self.page.click(self.page.middle(".player input[type=range]", x=0.6))
        seen = [self.picture()]
        for layer in ("follow", "truth", "ellipse", "particles", "ancestry", "map"):
            self.page.click(self.page.middle(f".player input[name={layer}]"))
            seen.append(self.picture())
        self.page.evaluate("""(() => {
            const chooser = document.querySelector(".player select[aria-label=cell]");
            chooser.value = "2";
            chooser.dispatchEvent(new Event("change"));
        })()""")
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
