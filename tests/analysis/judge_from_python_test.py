#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Estimators in NumPy, judged from Python by arrays alone: judge_from_python_test.py PROGRAM."""
import doctest
import os
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py  # noqa: F401, the module needs it
    import numpy as np
    import pandas  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing.name} is not installed (python3-h5py, python3-pandas)")
    sys.exit(77)

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../../analysis/readers"))
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
        self.assertIn(found.sentence, repr(found))
        self.assertIn("optimistic", found._repr_html_())

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
        nis = draw.chisquare(2, (30, 25))
        found = montecarta.judge_estimates(estimates, truths, P, error="world", nis=nis, nis_dof=2)
        self.assertIn(found.answer, ("consistent", "undecided"), found)
        self.assertAlmostEqual(found.ratio.estimate, 1.0, delta=0.1)
        with self.assertRaisesRegex(ValueError, "--error is missing"):
            montecarta.judge_estimates(estimates, truths, P)

    def test_refuses_arrays_that_do_not_fit(self):
        errors, covariances = kalman_filter(5, 6, 1.0)
        with self.assertRaisesRegex(ValueError, "^covariance has the axes"):
            montecarta.judge(errors, covariances[:, :-1])
        with self.assertRaisesRegex(ValueError, "is not later"):
            montecarta.judge(errors, covariances, times=np.zeros(6))

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
            self.assertLess(read, 10 * os.path.getsize(path))  # a pass of each kind, not of each run
            theirs = montecarta.Judgement(output)
        self.assertEqual(theirs.ratio, montecarta.judge(errors, covariances).ratio)

    def test_runs_a_study(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "first.h5")
            results = montecarta.run("first_study", path, {"study.runs": 3})
            self.assertEqual(results.attrs["study"], "first_study")
            self.assertEqual(results["ekf_slam"].sizes["run"], 3)


def load_tests(_loader, tests, _pattern):
    tests.addTests(doctest.DocTestSuite(montecarta))
    return tests


if __name__ == "__main__":
    unittest.main(verbosity=2)
