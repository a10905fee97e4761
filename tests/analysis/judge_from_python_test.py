#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Estimators in NumPy, judged from Python by arrays alone: judge_from_python_test.py PROGRAM."""
import doctest
import gc
import importlib.util
import inspect
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

from documented_examples import example

try:
    import h5py  # noqa: F401, the module needs it
    import numpy as np
    import pandas
except ImportError as missing:
    print(f"skipped: {missing.name} is not installed (python3-h5py, python3-pandas)")
    sys.exit(77)

HERE = os.path.dirname(os.path.abspath(__file__))
READERS = os.path.join(HERE, "../../analysis/readers")
sys.path.insert(0, READERS)
if __name__ == "__main__":
    os.environ["MONTECARTA"] = os.path.abspath(sys.argv.pop(1))
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import montecarta  # noqa: E402


def kalman_filter(runs, scans, scale, seed=1):
    """Errors and covariances, times `scale`, of a Kalman filter for position and speed."""
    draw = np.random.default_rng(seed)
    F, Q, H, R = np.array([[1, 0.1], [0, 1]]), np.diag([1e-4, 1e-2]), np.array([[1.0, 0]]), 0.04
    x, m = draw.standard_normal((runs, 2)), np.zeros((runs, 2))
    P, errors, covariances = np.eye(2), [], []
    for _ in range(scans):
        x = x @ F.T + draw.standard_normal((runs, 2)) * np.sqrt(np.diag(Q))
        m, P = m @ F.T, F @ P @ F.T + Q
        K = P @ H.T / (H @ P @ H.T + R)
        z = x @ H.T + np.sqrt(R) * draw.standard_normal((runs, 1))
        m, P = m + (z - m @ H.T) @ K.T, P - K @ H @ P
        errors.append(m - x)
        covariances.append(np.broadcast_to(scale * P, (runs, 2, 2)))
    return np.stack(errors, 1), np.stack(covariances, 1)


class JudgeFromPython(unittest.TestCase):
    def test_finds_a_kalman_filter_consistent_and_one_that_claims_less_not(self):
        right = montecarta.judge(*kalman_filter(1500, 40, 1.0), names=["x_m", "v_mps"])
        self.assertEqual(right.answer, "consistent", right)
        self.assertTrue(right.ratio.lower < 1 < right.ratio.upper)
        right.raise_unless_consistent()
        few = montecarta.judge(*kalman_filter(12, 40, 1.0))
        few.raise_if_inconsistent()
        with self.assertRaisesRegex(AssertionError, "undecided"):
            few.raise_unless_consistent()
        wrong = montecarta.judge(*kalman_filter(300, 40, 0.8))
        self.assertEqual(wrong.answer, "optimistic", wrong)
        self.assertAlmostEqual(wrong.ratio.estimate, 1.25, delta=0.06)
        with self.assertRaisesRegex(AssertionError, "optimistic"):
            wrong.raise_if_inconsistent()
        slight = montecarta.judge(*kalman_filter(300, 40, 0.8), within=1.25)
        self.assertEqual(slight.answer, "optimistic", slight)
        self.assertIn("slightly optimistic", slight.sentence)
        slight.raise_if_inconsistent()
        with self.assertRaisesRegex(AssertionError, "slightly"):
            slight.raise_unless_consistent()

    def test_says_what_the_program_says(self):
        errors, covariances = kalman_filter(50, 20, 0.5)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "result.h5")
            found = montecarta.judge(errors, covariances, path=path, names=["x_m", "v_mps"])
            cells = found.tables()["cells"]
            self.assertEqual(montecarta.open(path).labels, ("estimator",))
        self.assertAlmostEqual(cells["nees_ratio"][0], found.ratio.estimate, places=4)
        families = found.families
        self.assertEqual(list(families.query("family == 'component'").member), ["x", "v"])
        self.assertTrue((families.select_dtypes("number").dtypes == float).all())
        self.assertIn(found.sentence, repr(found))
        self.assertIn("<td>v</td>", found._repr_html_())
        self.assertEqual(list(found.components), ["x", "v"])
        of_v = families.query("member == 'v' and family == 'component'").iloc[0]
        self.assertEqual(found.components["v"], tuple(of_v[["estimate", "lower", "upper"]]))
        self.assertEqual(montecarta.judge(errors[..., :1], covariances[..., :1, :1]).components, {})

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_draws_a_report(self):
        with tempfile.TemporaryDirectory() as folder:
            page = montecarta.judge(*kalman_filter(20, 20, 0.5)).report(os.path.join(folder, "a"))
            self.assertGreater(os.path.getsize(page), 10000)

    def test_judges_one_run_and_runs_that_lack_scans(self):
        errors, covariances = kalman_filter(40, 60, 1.0)
        one = montecarta.judge(errors[0], covariances[0] * 0.01)
        self.assertEqual(one.answer, "optimistic", one)
        self.assertIn("of fewer than 3 runs", one.sentence)
        errors[3, 7] = np.nan
        self.assertIn("1 of 2400 samples is missing",
                      montecarta.judge(errors, covariances).sentence)

    def test_judges_poses_by_their_truth_and_innovations(self):
        draw = np.random.default_rng(4)
        truths = np.cumsum(draw.standard_normal((30, 25, 3)), 1)
        estimates = truths + 0.1 * draw.standard_normal(truths.shape)
        P = np.broadcast_to(0.01 * np.eye(3), (30, 25, 3, 3))
        nis = 1.5 * draw.chisquare(2, (30, 25))
        nis[4, 7] = np.nan
        found = montecarta.judge_estimates(estimates, truths, P, error="world", nis=nis, nis_dof=2)
        self.assertIn(found.answer, ("consistent", "undecided"), found)
        self.assertAlmostEqual(found.ratio.estimate, 1.0, delta=0.1)
        self.assertAlmostEqual(found.nis.estimate, 1.5, delta=0.2)
        of_x = montecarta.judge_estimates(estimates, truths, P, error="world", components=["x"])
        self.assertNotIn("correlation", list(of_x.families.family))
        with self.assertRaisesRegex(ValueError, "^error is missing"):
            montecarta.judge_estimates(estimates, truths, P)

    def test_judges_position_and_rotation_by_themselves(self):
        draw = np.random.default_rng(6)
        errors = 0.1 * draw.standard_normal((40, 25, 6)) * [1, 1, 1, 3, 3, 3]
        P = np.broadcast_to(0.01 * np.eye(6), (25, 6, 6))
        found = montecarta.judge(errors, P, names="x_m,y_m,z_m,rx_rad,ry_rad,rz_rad")
        self.assertEqual(list(found.blocks), ["position", "rotation"])
        self.assertNotEqual(found.blocks["position"].answer, "optimistic")
        self.assertEqual(found.blocks["rotation"].answer, "optimistic")
        self.assertAlmostEqual(found.blocks["rotation"].ratio.estimate, 9, delta=1)
        self.assertRegex(str(found), r"\n  rotation: optimistic, NEES ratio [89]")
        self.assertIn("rotation: optimistic", found._repr_html_())

    def test_takes_any_array_of_the_same_numbers_alike(self):
        errors, _ = kalman_filter(10, 12, 1.0)
        errors = np.round(errors * 64)  # which every type has
        P = np.broadcast_to(64.0**2 * np.eye(2), (*errors.shape, 2))
        spacious = np.full((10, 12, 4), -9.0)
        spacious[..., ::2] = errors
        expected = montecarta.judge(errors, P).ratio
        for name, given, covariances in [
                ("lists", errors.tolist(), P.tolist()),
                ("single", errors.astype(np.float32), P.astype(np.float32)),
                ("half", errors.astype(np.float16), P.astype(np.float16)),
                ("long double", errors.astype(np.longdouble), P),
                ("big endian", errors.astype(">f8"), P.astype(">f8")),
                ("integers", errors.astype(np.int16), P.astype(int)),
                ("objects", errors.astype(object), P.astype(object)),
                ("Fortran", np.asfortranarray(errors), np.asfortranarray(P)),
                ("strides", spacious[..., ::2], P),
                ("masked", np.ma.masked_array(errors, np.zeros(errors.shape, bool)), P),
                ("data frames", [pandas.DataFrame(run) for run in errors], P),
                ("one covariance for all runs", errors, P[0])]:
            with self.subTest(name):
                self.assertEqual(montecarta.judge(given, covariances).ratio, expected)
        one = montecarta.judge(errors[0], P[0]).ratio
        self.assertEqual(montecarta.judge(pandas.DataFrame(errors[0]), P[:1]).ratio, one)
        of_run = np.arange(12.0) + np.linspace(0, 0.4, 10)[:, np.newaxis]
        for times in (np.arange(12), list(range(12)), pandas.Series(range(12)), of_run):
            self.assertEqual(montecarta.judge(errors, P, times).ratio, expected)
        for names in ("x_m,y_m", ("x_m", "y_m"), np.array(["x_m", "y_m"])):
            self.assertEqual(montecarta.judge(errors, P, names=names).ratio, expected)

    def test_counts_what_is_missing_masked_or_unusable(self):
        errors, P = kalman_filter(20, 12, 1.0)
        lacking = np.array(errors)
        lacking[2, 5] = np.nan
        masked = np.ma.masked_array(errors, np.isnan(lacking))
        for given in (lacking, masked):
            self.assertEqual(montecarta.judge(given, P).missing, 1)
        P[2, 5] = np.nan
        self.assertEqual(montecarta.judge(lacking, P).unusable, 0)
        for fault, what in [((0, 1, np.nan), "is not finite"), ((0, 1, np.inf), "is not finite"),
                            ((0, 1, 7.0), "is not symmetric"),
                            ((1, 1, -1.0), "has a negative variance"),
                            (([0, 1], [1, 0], 7.0), "is not positive semidefinite")]:
            wrong = np.array(P)
            wrong[3, 4][fault[:2]] = fault[2]
            found = montecarta.judge(lacking, wrong.astype(np.float32))
            self.assertEqual((found.unusable, found.missing), (1, 1), what)
            self.assertIn(f"the covariance {what} in 1 row, the first in run 3, scan 4",
                          repr(found))
            with self.assertRaises(montecarta.Inconsistent):
                found.raise_if_inconsistent()

    def test_refuses_what_does_not_fit_and_says_what_was_expected(self):
        e, P = kalman_filter(5, 6, 1.0)
        partly, lost = np.array(e), np.array(e)
        partly[2, 3, 0] = np.nan
        lost[1, 2] = np.nan
        nis = np.ones((5, 6))
        judge, estimates = montecarta.judge, montecarta.judge_estimates
        for expected, refused in [
                (r"^covariances has the shape \(5, 5, 2, 2\): expected {run, scan, d, d} = "
                 r"\(5, 6, 2, 2\) or .* errors has the shape \(5, 6, 2\)$",
                 lambda: judge(e, P[:, :-1])),
                (r"\(5, 6, 2\): expected .*\(5, 6, 2, 2\)", lambda: judge(e, np.ones(e.shape))),
                (r"covariances has the shape \(2, 2\)", lambda: judge(e, np.eye(2))),
                (r"expected .* \(6, 5, 2, 2\)", lambda: judge(e.transpose(1, 0, 2), P)),
                (r"\(5, 6\)", lambda: judge(e[..., 0], P[..., 0, 0])),
                (r"covariances has the shape \(5, 6, 2, 2\)", lambda: judge(e[0], P)),
                (r"errors has the shape \(\)", lambda: judge(None, P)),
                (r"errors has the shape \(0,\)", lambda: judge([], [])),
                (r"errors has the shape \(0, 6, 2\)", lambda: judge(e[:0], P[:0])),
                (r"errors has the shape \(6,\)", lambda: judge(pandas.Series(e[0, :, 0]), P[0])),
                ("errors is NaN everywhere", lambda: judge(e * np.nan, P)),
                ("errors is no array of numbers", lambda: judge([run[:2 + k % 2] for k, run in
                                                                enumerate(e)], P)),
                ("errors is no array of numbers", lambda: judge({"ekf": e}, P)),
                ("type complex128", lambda: judge(e + 0j, P)),
                ("type complex128", lambda: judge(np.ma.masked_array(e + 0j), P)),
                ("type bool", lambda: judge(e > 0, P)),
                ("type <U32", lambda: judge(e.astype(str), P)),
                ("^run 2, scan 3: some numbers of error are not finite", lambda: judge(partly, P)),
                ("^run 0, scan 0: .* not finite", lambda: judge(e * np.inf, P)),
                ("^the errors of run 5 are those of run 0",
                 lambda: judge(np.tile(e, (2, 1, 1)), np.tile(P, (2, 1, 1, 1)))),
                (r"times has the shape \(5,\): expected {scan} = \(6,\) or {run, scan} = \(5, 6\)",
                 lambda: judge(e, P, times=np.arange(5))),
                (r"times has the shape \(6, 5\)", lambda: judge(e, P, times=np.zeros((6, 5)))),
                (r"times has the shape \(\)", lambda: judge(e, P, times=0.1)),
                ("^run 0, scan 1: .* is not later", lambda: judge(e, P, times=np.zeros(6))),
                ("^run 0, scan 0: time nan", lambda: judge(e, P, times=np.full(6, np.nan))),
                ("type datetime64", lambda: judge(e, P, pandas.date_range("2020", periods=6))),
                ("nis and nis_dof", lambda: judge(e, P, nis=nis)),
                ("nis and nis_dof", lambda: judge(e, P, nis_dof=2)),
                (r"nis has the shape \(6, 5\)", lambda: judge(e, P, nis=nis.T, nis_dof=2)),
                (r"nis_dof has the shape \(5,\)", lambda: judge(e, P, nis=nis, nis_dof=nis[:, 0])),
                ("^run 0, scan 0: nis -1", lambda: judge(e, P, nis=-nis, nis_dof=2)),
                (r"names has 1 names \(x_m\): expected 2", lambda: judge(e, P, names=["x_m"])),
                ("no name of its own", lambda: judge(e, P, names=["x_m", "x_m"])),
                ("no component 'z'", lambda: judge(e, P, components=["z"])),
                ("^within 0.5: not usable", lambda: judge(e, P, within=0.5)),
                ("/none/x.h5.*make the folder first", lambda: judge(e, P, path="/none/x.h5")),
                (r"names has 3 names .*: expected 2", lambda: estimates(e, e, P)),
                (r"^truths has the shape \(5, 5, 2\)",
                 lambda: estimates(e, e[:, :-1], P, names=["a_m", "b_m"])),
                ("^truths is NaN at run 1, scan 2",
                 lambda: estimates(e, lost, P, names=["a_m", "b_m"])),
                ("^error map: not known", lambda: estimates(e, e, P, "map", names="a_m,b_m"))]:
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected) as caught:
                refused()
            self.assertNotIn(tempfile.gettempdir(), str(caught.exception))

    def test_has_type_hints_and_docstrings(self):
        self.assertTrue(os.path.exists(os.path.join(READERS, "montecarta/py.typed")))
        calls = [montecarta.judge, montecarta.judge_estimates, montecarta.run, montecarta.open,
                 montecarta.arrays, montecarta.at_scans, montecarta.pose_error, montecarta.program]
        for one in (montecarta.Judgement, montecarta.Results):
            calls += [call for name, call in vars(one).items()
                      if inspect.isfunction(call) and not name.startswith("_")]
        for call in calls:
            with self.subTest(call.__name__):
                signature = inspect.signature(call)
                hints = {p.name: p.annotation for p in signature.parameters.values()}
                hints |= {"return": signature.return_annotation, "self": "one of them"}
                self.assertNotIn(inspect.Signature.empty, hints.values(), hints)
                self.assertRegex(call.__doc__, "(Returns|Raises)\n *-------?\n")

    def test_keeps_the_result_as_long_as_the_judgement(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch("tempfile.tempdir", folder):
            found = montecarta.judge(*kalman_filter(5, 6, 1.0))
            self.assertEqual(montecarta.open(found.path).labels, ("estimator",))
            with self.assertRaises(ValueError):
                montecarta.judge(np.zeros((3, 2, 1)), np.zeros((3, 2, 1, 1)), within=0)
            self.assertEqual(len(os.listdir(folder)), 1)
            del found
            gc.collect()
            self.assertEqual(os.listdir(folder), [])

    def test_refuses_a_program_that_is_none(self):
        with mock.patch.dict(os.environ, {"MONTECARTA": "/none/montecarta"}):
            with self.assertRaisesRegex(FileNotFoundError, "MONTECARTA is /none/montecarta"):
                montecarta.program()

    def test_the_documented_script_finds_what_it_says(self):
        script = example("judged as it is and with too small variances:")
        done = subprocess.run([sys.executable, "-B", "-c", script], check=True, text=True,
                              capture_output=True, env=os.environ | {"PYTHONPATH": READERS})
        right, wrong = done.stdout.splitlines()
        self.assertRegex(right, "^estimator is consistent within 1.1")
        self.assertRegex(wrong, r"^estimator is optimistic .* 1\.2\d times")

    def test_the_documented_test_fails_when_a_filter_becomes_inconsistent(self):
        runner = ["-m", "pytest", "-q", "-p", "no:cacheprovider"]
        if importlib.util.find_spec("pytest") is None:
            runner = ["-c", "import test_filter; test_filter.test_filter_is_consistent()"]
        with tempfile.TemporaryDirectory() as folder:
            test = os.path.join(folder, "test_filter.py")
            with open(test, "w", encoding="utf-8") as file:
                file.write(example("fails when a change makes your filter inconsistent:"))
            for scale, code in [(1.0, 0), (0.7, 1)]:
                with open(os.path.join(folder, "my_filter.py"), "w", encoding="utf-8") as file:
                    file.write("from judge_from_python_test import kalman_filter\n"
                               f"def simulate(runs): return kalman_filter(runs, 40, {scale})\n")
                path = os.pathsep.join([folder, HERE, READERS])
                done = subprocess.run([sys.executable, "-B", *runner], cwd=folder, check=False,
                                      env=os.environ | {"PYTHONPATH": path}, text=True,
                                      capture_output=True)
                said = done.stdout + done.stderr
                self.assertEqual(done.returncode, code, said)
                self.assertEqual("Inconsistent: estimator is optimistic" in said, code == 1, said)

    @unittest.skipUnless(os.path.isdir("/proc/self"), "reads of a process are not counted here")
    def test_the_program_reads_compressed_chunks_of_many_runs_once(self):
        errors = np.random.default_rng(5).standard_normal((300, 250, 2))
        covariances = np.broadcast_to(np.eye(2), (*errors.shape, 2))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "arrays.h5")
            with h5py.File(path, "w") as file:
                for name, values in [("error", errors), ("covariance", covariances)]:
                    file.create_dataset(name, data=values, compression="gzip",
                                        chunks=(300, 25) + (1,) * (values.ndim - 2))
            output = os.path.join(folder, "result.h5")
            judging = subprocess.Popen([montecarta.program(), "judge", path, "-o", output],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            os.waitid(os.P_PID, judging.pid, os.WEXITED | os.WNOWAIT)  # its counts are still there
            with open(f"/proc/{judging.pid}/io", encoding="ascii") as file:
                read = int(file.readline().split()[1])
            self.assertEqual(judging.wait(), 0)
            self.assertLess(read, 10 * os.path.getsize(path))  # not once for each run
            theirs = montecarta.Judgement(output)
        self.assertEqual(theirs.ratio, montecarta.judge(errors, covariances).ratio)

    def test_runs_a_study(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "first.h5")
            results = montecarta.run("first_study", path, {"study.runs": 3})
            self.assertEqual(results.attrs["study"], "first_study")
            self.assertEqual(results["ekf_slam"].sizes["run"], 3)


def load_tests(_loader, tests, _pattern):
    for module in (montecarta._judging, montecarta._results):
        tests.addTests(doctest.DocTestSuite(module))
    return tests


if __name__ == "__main__":
    unittest.main(verbosity=2)
