# SPDX-License-Identifier: BSD-3-Clause
"""montecarta from Python: judge the errors of an estimator, run studies, and read result files
(analysis/FORMAT.md).

    import montecarta

    result = montecarta.judge(errors, covariances)  # {run, scan, d} and {run, scan, d, d}
    print(result.sentence)                          # "... is optimistic (overconfident): ..."
    result.raise_if_inconsistent()                  # in a test of the estimator

    results = montecarta.open("first_study.h5")
    results.labels                                  # ("ekf_slam", "fastslam1_m100", ...)
    cell = results["ekf_slam"]                      # xarray.Dataset, read where it is used
    cell.pose_mean.sel(component="x").sel(time=12.5, method="nearest")
    montecarta.at_scans(cell)                       # complete runs, at the scans
    results.tables()["cells"]                       # pandas.DataFrame, with the verdicts

`open` and `arrays` read files alone; everything else needs the program (see `program`), NumPy and
h5py. Tables need pandas, and cells of results xarray and netCDF4.
"""
from ._judging import Block, Inconsistent, Judgement, Ratio, judge, judge_estimates
from ._program import program
from ._results import Results, arrays, at_scans, open, pose_error, run

__all__ = ["Block", "Inconsistent", "Judgement", "Ratio", "Results", "arrays", "at_scans", "judge",
           "judge_estimates", "open", "pose_error", "program", "run"]
