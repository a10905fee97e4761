# SPDX-License-Identifier: BSD-3-Clause
"""The comparison with printed numbers, on tables of our own making."""
import contextlib
import glob
import io
import os
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
sys.path.insert(0, os.path.join(SOURCE, "experiments"))
try:
    import numpy as np
    import printed
except (ImportError, SystemExit):
    print("skipped: python3-scipy is not installed (bash .ci/install-packages convert)")
    sys.exit(77)


class Printed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def measured(self, scores, name="all", anees=None):
        """A folder of `analyze --csv` with these scores {label: [position_rmse, ...]} and the
        average NEES of the pose {label: [..., ...]} at 0.2 s, 0.4 s and so on."""
        self.write(f"{name}/cells.csv", "cell\n" + "".join(f"{label}\n" for label in scores))
        self.write(f"{name}/runs.csv", "cell,run,position_rmse [m]\n" + "".join(
            f"{label},{run},{value}\n" for label, row in scores.items()
            for run, value in enumerate(row)))
        self.write(f"{name}/consistency.csv", "cell,error,covariance\n" + "".join(
            f"{label},pose,corrected\n{label},pose,spread\n" for label in scores))
        for label, row in (anees or {}).items():
            self.write(f"{name}/series_{label}.csv", "time [s],anees_pose_corrected\n" + "".join(
                f"{0.2 * (k + 1):.1f},{value}\n" for k, value in enumerate(row)))
        return printed.Measured(os.path.join(self.folder, name))

    def says(self, text):
        return printed.read_printed(self.write("paper.printed", text))

    def verdicts(self, text, measured, batches=()):
        paper = self.says(text)
        with contextlib.redirect_stdout(io.StringIO()):
            printed.compare(paper, measured, batches)
        return ([printed.another_world(value, paper, measured, batches)
                 or printed.judge_value(value, paper, measured, batches)[2]
                 for value in paper["value"]]
                + [printed.judge_claim(claim, paper, measured, batches)[2]
                   for claim in paper["claim"]])

    def test_a_number_agrees_if_so_many_runs_of_ours_would_have_it(self):
        # 100 runs with mean 2 and deviation 1; of 4 runs the mean is within 2 +- 1.98 x 0.51.
        measured = self.measured({"a": np.tile([1.0, 3.0], 50)})
        for number, verdict in (("2.9", "agrees"), ("1.1", "agrees"),
                                ("3.1", "differs: 1.6 times smaller"),
                                ("0.9", "not reproduced: 2.2 times as large"),
                                ("4.2", "not reproduced: 2.1 times smaller"),
                                ("2", "agrees")):
            text = f"runs = 4\nvalue = cell=a metric=position_rmse printed={number}"
            self.assertEqual(self.verdicts(text, measured), [verdict], number)

    def test_a_single_run_must_be_among_ours(self):
        measured = self.measured({"a": [1.0] * 39 + [9.0]})
        value = "value = cell=a metric=position_rmse printed="
        self.assertEqual(self.verdicts(value + "0.5", measured),
                         ["not reproduced: 2.4 times as large"])
        self.assertEqual(self.verdicts(value + "3.0", measured), ["agrees"])

    def test_ratios_compare_machines(self):
        measured = self.measured({"a": [2.0, 4.0, 6.0], "b": [1.0, 2.0, 3.0]})
        value = "value = cell=a relative_to=b metric=position_rmse printed="
        self.assertEqual(self.verdicts(value + "2.0", measured), ["agrees"])
        self.assertEqual(self.verdicts(value + "1.5", measured), ["differs: 1.3 times as large"])

    def test_a_baseline_that_is_far_off_is_another_world(self):
        measured = self.measured({"a": [1.0, 1.1], "b": [5.0, 5.1]})
        text = ("baseline = b\nvalue = cell=b metric=position_rmse printed=1.2\n"
                "value = cell=a metric=position_rmse printed=1.0\n")
        self.assertEqual(self.verdicts(text, measured),
                         ["not reproduced: 4.2 times as large",
                          "another world: b: 4.2 times as large"])

    def test_numbers_of_a_substitute_for_the_world_are_not_compared(self):
        measured = self.measured({"a": [1.0, 1.1], "b": [5.0, 5.1]})
        text = ("source = A paper\nsubstitute = loop\nclaim = position_rmse a < b\n"
                "value = cell=a metric=position_rmse printed=1.05\n"
                "value = cell=b metric=position_rmse printed=1.2\n")
        other = "another world: loop in place of the paper's"
        self.assertEqual(self.verdicts(text, measured), [other, other, "holds"])
        lead = self.lead(text, measured)
        self.assertNotIn("printed number", lead)
        self.assertIn("loop stands in place of the paper's world", lead)

    def test_claims_are_judged_run_by_run(self):
        # The runs differ by far more than the cells, which differ in each run.
        base = np.linspace(1.0, 100.0, 50)
        measured = self.measured({"a": base, "b": base + 1.0 + 0.1 * (-1.0) ** np.arange(50),
                                  "c": base[::-1]})
        for claim, verdict in (("a < b", "holds"), ("a > b", "contradicted"),
                               ("a < c", "undecided"), ("a ~ b", "holds")):
            self.assertEqual(self.verdicts(f"claim = position_rmse {claim}", measured), [verdict])

    def test_the_right_side_may_be_a_number_or_a_multiple(self):
        measured = self.measured({"a": np.tile([2.0, 2.2, 2.1], 10),
                                  "b": np.tile([1.0, 1.3, 1.15], 10)})
        for claim, verdict in (("a < 2.5", "holds"), ("a > 2.5", "contradicted"),
                               ("a < 3*b", "holds"), ("a < 1.5*b", "contradicted"),
                               ("a ~ 2.1", "holds"), ("b < 1.15", "undecided")):
            self.assertEqual(self.verdicts(f"claim = position_rmse {claim}", measured), [verdict])

    def test_columns_are_subtracted(self):
        measured = self.measured({"a": np.tile([2.0, 2.2, 2.1], 10),
                                  "b": np.tile([1.0, 1.3, 1.15], 10)})
        for rows in measured.runs.values():
            for row in rows.values():
                row["landmark_rms"] = "1.5"
        for claim, verdict in (("a > b", "holds"), ("a > 0.3", "holds"), ("b > 0", "contradicted")):
            text = f"claim = position_rmse-landmark_rms {claim}"
            self.assertEqual(self.verdicts(text, measured), [verdict])
        with self.assertRaisesRegex(printed.PrintedError, "no column 'none'"):
            self.verdicts("claim = position_rmse-none a > b", measured)

    def test_a_variance_between_runs_is_compared(self):
        wave = (-1.0) ** np.arange(50) * np.linspace(0.5, 1.5, 50)
        measured = self.measured({"a": 5.0 + wave, "b": 9.0 + 3.0 * wave})
        self.assertEqual(self.verdicts("claim = variance_of_position_rmse a < b\n", measured),
                         ["holds"])
        left, right = printed.paired(measured, "a", "b", "variance_of_position_rmse").mean(0)
        self.assertAlmostEqual(left, np.var(wave, ddof=1))
        self.assertAlmostEqual(right, 9.0 * np.var(wave, ddof=1))

    def test_numbers_of_a_band_are_those_of_batches(self):
        rising = {"a": [3.0, 1.0, 5.0, 6.0], "b": [3.0, 3.0, 3.0, 3.0]}
        later = {"a": [3.0, 3.0, 3.0, 6.0], "b": [3.0, 3.0, 3.0, 3.0]}
        runs = {"a": [1.0] * 30, "b": [1.0] * 30}
        batches = [self.measured(runs, "one", rising), self.measured(runs, "two", later)]
        text = ("runs = 30\nband = pose 2.19 3.93\n"
                "value = cell=a metric=stays_above_from_pose printed=0.7\n"
                "value = cell=a metric=stays_above_from_pose printed=80\n"
                "value = cell=a metric=share_inside_pose printed=0.5\n"
                "value = cell=b metric=stays_above_from_pose printed=0.5\n"
                "claim = stays_above_from_pose b > a\nclaim = share_inside_pose a > b\n"
                )
        self.assertEqual(self.verdicts(text, batches[0], batches),
                         ["agrees", "not reproduced: 1.1e+02 times smaller", "agrees",
                          "not reproduced: never", "holds in 2 of 2 batches",
                          "contradicted in 2 of 2 batches"])
        self.assertEqual(self.verdicts("claim = stays_above_from_pose b > a\n", batches[0]),
                         ["holds, over all runs"])
        # If no band is printed, it is that of 30 runs and 3 components, [2.19, 3.93] as well.
        self.assertAlmostEqual(batches[0].by_band("a", "share_inside_pose", {}), 0.25)
        self.assertAlmostEqual(batches[0].by_band("a", "share_inside_pose", {"pose": (0, 9)}), 1.0)

    def test_refuses_a_line_that_it_does_not_understand(self):
        for line in ("quote = 3", "value = cell=a printed=1", "value = cell=a metric=b printed=one",
                     "value = cell=a metric=share_inside_pose printed=1 relative_to=b",
                     "value = cell=a cell=b metric=c printed=1", "claim = nees a < ", "runs = many",
                     "claim = nees a = b", "band = pose 3 2", "source = again", "runs = -3",
                     "claim = share_inside_pose a ~ b",
                     "value = cell=a metric=b printed=inf",
                     "value = cell=a metric=b printed=1 runs=0", "value = cell=a note=\"open"):
            with self.assertRaisesRegex(printed.PrintedError, "paper.printed:2: "):
                self.says("source = A paper\n" + line)

    def test_names_a_missing_cell_metric_or_file(self):
        measured = self.measured({"a": [1.0, 2.0]})
        for line, piece in (("claim = position_rmse a < z", "there is no cell 'z'"),
                            ("claim = sharpness a < a", "there is no column 'sharpness'")):
            with self.assertRaisesRegex(printed.PrintedError, piece):
                self.verdicts(line, measured)
        self.write("all/runs.csv", "cell,run,position_rmse [m]\na,0\n")
        with self.assertRaisesRegex(printed.PrintedError, "runs.csv: cannot be read"):
            printed.Measured(os.path.join(self.folder, "all"))
        script = os.path.join(SOURCE, "experiments/printed.py")
        called = subprocess.run([sys.executable, "-B", script, "absent.printed", self.folder],
                                stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(called.returncode, 2)
        self.assertIn("printed.py: absent.printed: cannot be read", called.stderr)

    def lead(self, text, measured):
        with contextlib.redirect_stdout(io.StringIO()):
            return " ".join(printed.compare(self.says(text), measured, ()).split())

    def test_three_sentences_lead_to_the_comparison(self):
        measured = self.measured({"a": np.tile([1.0, 3.0], 50), "b": np.tile([2.0, 4.5], 50)})
        text = ("source = A paper, 2016; Table 1\nruns = 20\n"
                'claim = position_rmse a < b note="Fig. 3"\n'
                "claim = position_rmse b < a\n"
                'claim = position_rmse a > b note="not in the paper: ours"\n'
                "value = cell=a metric=position_rmse printed=2\n"
                "value = cell=b metric=position_rmse printed=99\n")
        self.assertEqual(self.lead(text, measured), " ".join((
            "A paper, 2016; Table 1, says that the position RMSE of a is less than that of b "
            "(Fig. 3), makes 1 more claim of this kind, and prints 2 numbers that can be compared.",
            "We find: the first claim holds (the left side minus the right side is -1.25 \\[-1.3, "
            "-1.2\\]); of all 2 claims, 1 holds, 1 is contradicted and 0 are undecided; of 2 "
            "printed numbers, 1 agrees with ours.",
            "How sure: each cell has 100 complete runs (the paper has 20), cells are compared run "
            "by run, and intervals are at 95 %.")))

    def test_the_sentences_say_that_the_paper_had_another_world(self):
        measured = self.measured({"a": [1.0] * 20, "b": [9.0] * 5})
        lead = self.lead("source = A paper\nbaseline = a\n"
                         "value = cell=a metric=position_rmse printed=4", measured)
        self.assertIn("A paper, prints 1 number that can be compared.", lead)
        self.assertIn("each cell has 5 to 20 complete runs (the paper does not say of how many its",
                      lead)
        self.assertIn("but the position RMSE of a itself is 4 times smaller, so", lead)

    def test_the_sentences_are_written_to_a_file(self):
        self.measured({"a": [1.0, 2.0], "b": [2.0, 4.0]})
        path = self.write("paper.printed", "source = A paper\nclaim = position_rmse a < b\n")
        script = os.path.join(SOURCE, "experiments/printed.py")
        call = [sys.executable, "-B", script, path, os.path.join(self.folder, "all"), "--lead"]
        to = os.path.join(self.folder, "lead.md")
        subprocess.run(call + [to], stdout=subprocess.PIPE, check=True)
        with open(to, encoding="utf-8") as file:
            self.assertTrue(file.read().startswith("A paper, says that the position RMSE of a"))
        failed = subprocess.run(call + [os.path.join(to, "no")], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(failed.returncode, 2)
        self.assertIn("cannot be written", failed.stderr)

    def test_every_file_beside_a_study_is_understood_and_names_its_cells(self):
        files = glob.glob(os.path.join(SOURCE, "experiments/studies/*.printed"))
        self.assertGreater(len(files), 5)
        for path in files:
            paper = printed.read_printed(path)
            with open(path.removesuffix(".printed") + ".ini", encoding="utf-8") as file:
                study = file.read()
            for each in paper["value"]:
                self.assertIn(each["cell"].rsplit("_m", 1)[0], study)
            for each in paper["claim"]:
                self.assertIn(each["left"].rsplit("_m", 1)[0], study)


if __name__ == "__main__":
    unittest.main()
