# SPDX-License-Identifier: BSD-3-Clause
"""montecarta from Python: judge the errors of an estimator, run studies, and read result files
(analysis/FORMAT.md). One file, to be copied. Reading needs nothing else of montecarta; what the
program computes needs the program (see `program`).

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
"""
from __future__ import annotations

import html
import json
import os
import shutil
import subprocess
import tempfile
from typing import NamedTuple, Optional, Sequence

import numpy as np

POSE = ["x", "y", "heading"]


def program() -> str:
    """The path of the program: the environment variable MONTECARTA, else that of the source tree or
    the package to which this file belongs, else the one in PATH. Raises FileNotFoundError if there
    is none."""
    here = os.path.dirname(os.path.abspath(__file__))
    near = [os.path.join(here, *parts, "montecarta") for parts in
            [("..", "..", "build"), ("..", "..", "..", "bin"), ("bin",)]]
    for path in [os.environ.get("MONTECARTA"), *near, shutil.which("montecarta")]:
        if path and os.path.isfile(path) and os.access(path, os.X_OK):
            return os.path.normpath(path)
    raise FileNotFoundError("no program montecarta is in build, beside this module or in PATH: "
                            "build it (bash experiments/first_study), install the Debian package, "
                            "or set MONTECARTA to its path")


def _call(*words: str) -> subprocess.CompletedProcess:
    """Calls the program. Raises ValueError with its message if it refuses its input."""
    done = subprocess.run([program(), *words], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4, 5):  # the answers of gate
        raise ValueError(done.stderr.strip().removeprefix("montecarta: ") or
                         f"{program()} ended with code {done.returncode} and said nothing")
    return done


class Ratio(NamedTuple):
    """A ratio of squared errors to the expected ones with its 95 % interval; 1 is right."""

    estimate: float
    lower: float
    upper: float


class Inconsistent(AssertionError):
    """An estimator is shown not to be consistent."""


class Judgement:
    """The verdict on an estimator (analysis/STATISTICS.md, chapter 5).

    Attributes
    ----------
    answer : str
        "consistent" within the margin, "optimistic", "conservative", "inconsistent", "undecided" or
        "untested".
    sentence : str
        The answer in words, with what was shown.
    ratio : Ratio
        Mean of the squared errors in units of their covariance [1], with its interval.
    notes : list of str
        What is likely a mistake in the input.
    path : str
        The result file, which `open` reads and `montecarta report` draws.
    """

    def __init__(self, path: str, notes: Sequence[str] = (), within: Optional[float] = None,
                 folder: Optional[tempfile.TemporaryDirectory] = None):
        self._folder = folder  # which is removed when nobody holds this judgement any more
        margin = [] if within is None else ["--within", str(within)]
        self._json = json.loads(_call("gate", path, "--json", *margin).stdout)
        self.path, self.notes, self._margin = path, list(notes), margin
        self.answer: str = self._json["verdict"]
        self.sentence: str = self._json["reason"]
        size = next((test["members"][0] for test in self._json["families"]
                     if test["family"] == "size"), None)
        self.ratio = Ratio(size["estimate"], *size["interval"]) if size else Ratio(*[np.nan] * 3)

    @property
    def families(self):
        """The tests of the verdict as a pandas.DataFrame, one row for each member of a family. Of
        the scans only the one with the least p-value is there."""
        import pandas

        return pandas.DataFrame([
            {"family": test["family"], "member": member["name"], "estimate": member["estimate"],
             "lower": member["interval"][0], "upper": member["interval"][1], "p": member["p"],
             "family_p": test["p"], "shown": member["shown"]}
            for test in self._json["families"] for member in test["members"]])

    def tables(self):
        """All tables of `montecarta analyze`, as {name: pandas.DataFrame}."""
        return Results(self.path).tables(program(), *self._margin)

    def report(self, folder: str) -> str:
        """Writes a page with figures into `folder` and returns its path. It needs gnuplot."""
        _call("report", self.path, "-o", os.fspath(folder), "--force", *self._margin)
        return os.path.join(folder, "index.html")

    def raise_if_inconsistent(self) -> None:
        """Raises Inconsistent, an AssertionError, with the sentence if the estimator is shown not
        to be consistent within the margin, optimistic or conservative, or if nothing could be
        judged. Too few runs to decide are no error."""
        if self._json["gate"] == "inconsistent" or self.answer == "untested":
            raise Inconsistent(self.sentence)

    def raise_unless_consistent(self) -> None:
        """Raises Inconsistent with the sentence unless the estimator is shown to be consistent
        within the margin: also if too few runs were judged to decide."""
        if self._json["gate"] != "consistent":
            raise Inconsistent(self.sentence)

    def __repr__(self) -> str:
        return "\n".join([self.sentence, *("note: " + note for note in self.notes)])

    def _repr_html_(self) -> str:
        colour = {"consistent": "#2a7d3f", "undecided": "#777", "untested": "#777"}
        notes = "".join(f"<li>{html.escape(note)}</li>" for note in self.notes)
        return (f"<p><b style='color:{colour.get(self.answer, '#b3261e')}'>{self.answer}</b>, NEES "
                f"ratio {self.ratio.estimate:.3g} [{self.ratio.lower:.3g}, {self.ratio.upper:.3g}]"
                f"<br>{html.escape(self.sentence)}</p>" + (f"<ul>{notes}</ul>" if notes else ""))


def judge(errors, covariances, times=None, nis=None, names=None, within: float = 1.1, *,
          nis_dof=None, path: Optional[str] = None) -> Judgement:
    """Judges the errors of an estimator by the covariances that it states.

    Parameters
    ----------
    errors : array_like, {run, scan, d}, or {scan, d} of one run
        Estimate minus truth, in the frame and chart of the covariance. Runs are independent. A scan
        whose errors are all NaN is missing.
    covariances : array_like, {run, scan, d, d}, or {scan, d, d}
        The covariance that the estimator stated for each error.
    times : array_like, {scan} or {run, scan}, optional
        Times [s]; by default the numbers of the scans.
    nis, nis_dof : array_like, {run, scan}, optional
        Normalised innovations squared, and their numbers of components (an array or one number),
        which are judged too. NaN where nothing was observed.
    names : sequence of str, {d}, optional
        Names of the components, with a unit, e.g. ["x_m", "heading_rad"].
    within : float
        Ratios of squared errors from 1 / within to within are consistent.
    path : str, optional
        Where to keep the result file; by default it goes with the judgement.

    Returns
    -------
    Judgement

    Raises
    ------
    ValueError
        If arrays do not fit, with the reason and a remedy.

    Examples
    --------
    >>> import numpy as np
    >>> errors = np.random.default_rng(1).standard_normal((300, 100, 2))
    >>> judge(errors, np.broadcast_to(np.eye(2), (300, 100, 2, 2))).answer
    'consistent'
    >>> judge(errors, np.broadcast_to(0.8 * np.eye(2), (300, 100, 2, 2))).answer
    'optimistic'
    """
    return _judge({"error": errors}, covariances, times, nis, nis_dof, names, within, path)


def judge_estimates(estimates, truths, covariances, error: Optional[str] = None, times=None,
                    nis=None, names=("x_m", "y_m", "heading_rad"), within: float = 1.1, *,
                    nis_dof=None, path: Optional[str] = None) -> Judgement:
    """Judges estimates by their truths, of poses by the error that the covariance describes.

    Parameters
    ----------
    estimates : array_like, {run, scan, column}, or {scan, column} of one run
        States in the order of `names`. A scan that is all NaN is missing.
    truths : array_like, like `estimates`, or {scan, column} of all runs
        True states.
    covariances : array_like, {run, scan, d, d}, or {scan, d, d}
        Covariances [units of the components], for poses position first.
    error : str, optional
        "world", "body" or "right-invariant": the error of the covariance of a pose (`montecarta
        judge --help`).
    names : sequence of str
        Columns of the state; ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"] is a pose in space.

    Other parameters, what is returned and what is raised are those of `judge`.
    """
    estimates, truths = _numbers(estimates), _numbers(truths)
    if estimates.ndim == truths.ndim == 2 and estimates.shape != truths.shape:
        raise ValueError(f"truths have the shape {truths.shape}, estimates {estimates.shape}: give "
                         "both the same scans and columns")
    return _judge({"mean": estimates, "truth": truths}, covariances, times, nis, nis_dof, names,
                  within, path, [] if error is None else ["--error", error])


def _numbers(values) -> np.ndarray:
    """An array of floats; masked numbers are NaN."""
    if np.ma.isMaskedArray(values):
        values = np.ma.filled(np.ma.asarray(values, float), np.nan)
    return np.asarray(values, float)


def _judge(states, covariances, times, nis, nis_dof, names, within, path, options=()):
    import h5py

    arrays = {name: _numbers(values) for name, values in states.items()}
    arrays["covariance"] = _numbers(covariances)
    if arrays["covariance"].ndim == 3:  # one run
        arrays |= {name: values[np.newaxis] for name, values in arrays.items()
                   if values.ndim == (3 if name == "covariance" else 2)}
    of_scans = next(iter(arrays.values())).shape[:2]
    if times is not None:
        arrays["time"] = _numbers(times)
    if nis is not None:
        arrays["nis"] = _numbers(nis) if np.ndim(nis) == 2 else _numbers(nis)[np.newaxis]
        if arrays["nis"].shape != of_scans:
            raise ValueError(f"nis has the shape {np.shape(nis)} (runs and scans are {of_scans}): "
                             "give one number for each scan")
        if nis_dof is None:
            raise ValueError("nis needs nis_dof, the number of components of each: give it")
        arrays["nis_dof"] = np.broadcast_to(_numbers(nis_dof), of_scans)
    with tempfile.TemporaryDirectory() as folder:
        given = os.path.join(folder, "estimates.h5")
        with h5py.File(given, "w") as file:
            for name, values in arrays.items():
                file[name] = values
            if names is not None:
                file.attrs["names"] = ",".join(map(str, names))
        kept = None if path else tempfile.TemporaryDirectory(prefix="montecarta-")
        path = path or os.path.join(kept.name, "result.h5")
        try:
            done = _call("judge", given, "-o", os.fspath(path), "--force", "--cell", "estimator",
                         "--within", str(within), *options)
        except ValueError as error:
            raise ValueError(str(error).replace(given + ": ", "")) from None
    notes = [line.removeprefix("montecarta: note: ") for line in done.stderr.splitlines()
             if line.startswith("montecarta: note: ")]
    return Judgement(os.fspath(path), notes, within, kept)


def run(study: str, output: str, settings: Optional[dict] = None) -> Results:
    """Runs a study and returns its results. Progress is shown where standard error is a terminal.

    Parameters
    ----------
    study : str
        A study file, or the name of a shipped one, e.g. "first_study".
    output : str
        The result file. An unfinished one is continued; one that is finished is kept.
    settings : dict, optional
        Changed settings, e.g. {"study.runs": 100}.

    Raises
    ------
    subprocess.CalledProcessError
        If the program fails; it says why on standard error.
    """
    changes = [word for name, value in (settings or {}).items()
               for word in ("--set", f"{name}={value}")]
    unfinished = ["--resume"] if os.path.exists(f"{output}.part") else []
    if not os.path.exists(output) or unfinished:
        subprocess.run([program(), "run", study, "-o", os.fspath(output), *changes, *unfinished],
                       check=True, stdout=subprocess.DEVNULL)
    return Results(output)


class Results:
    """A result file. `labels` are its cells; `attrs` its own attributes (study, title, seed, runs);
    `study` the study file with everything filled in; `scenario` and `provenance` dictionaries."""

    def __init__(self, path):
        import h5py

        self.path = os.fspath(path)
        with h5py.File(self.path, "r") as file:
            if file.attrs.get("filetype") not in ("montecarta-results", b"montecarta-results"):
                raise ValueError(f"{self.path}: no montecarta result file: name one that "
                                 "`montecarta run` wrote")
            self.labels = tuple(file["cells"])
            self.attrs = _plain(file.attrs)
            self.study = file["provenance/study"].asstr()[()]
            self.scenario = _plain(file["scenario"].attrs)
            self.provenance = _plain(file["provenance"].attrs)
            self._settings = {label: _plain(cell["settings"].attrs)
                              for label, cell in file["cells"].items()}

    def __iter__(self):
        return iter(self.labels)

    def __getitem__(self, label):
        """One cell as an xarray.Dataset: every dataset of it, `truth` and `truth_*` where true
        paths are stored, `scan_row`; coordinates run, time [s], scan [s], component (x, y,
        heading). Runs that are drives of their own have no common times: without the coordinates
        time and scan, and without scan_row where poses are stored between scans. `attrs`
        holds the filter and its settings. Raises KeyError where there is no such cell."""
        import xarray

        if label not in self.labels:
            raise KeyError(f"{self.path} has no cell {label!r}: it has {', '.join(self.labels)}")
        root = xarray.open_dataset(self.path, engine="netcdf4")
        cell = xarray.open_dataset(self.path, engine="netcdf4", group="cells/" + label)
        cell = cell.assign_coords(run=root.run)
        if not self._has("scenario/drives/drive_00000/step_time"):
            cell = cell.assign(scan_row=root.scan_row)
        if self._has("scenario/drives"):
            cell = cell.drop_vars(["time", "scan"], errors="ignore")
        else:
            cell = cell.assign_coords(time=root.time, scan=root.scan)
        cell.attrs = self._settings[label] | cell.attrs
        if self._has("truth/pose"):
            truth = xarray.open_dataset(self.path, engine="netcdf4", group="truth")
            cell = cell.assign({"truth" if name == "pose" else "truth_" + name: truth[name]
                                for name in truth})
        if "failure_reason" in cell:
            texts = [row.tobytes().rstrip(b"\0").decode() for row in cell.failure_reason.values]
            cell = cell.drop_dims("character").assign(failure_reason=("run", texts))
        names = {axis: POSE for axis in ("component", "component_column")
                 if cell.sizes.get(axis) == 3}
        if "error_component" in cell.sizes:
            components = cell.attrs["components"].replace(",", " ").split()
            names |= {axis: components for axis in ("error_component", "error_component_column")}
        return cell.assign_coords(names)

    def tables(self, program=None, *options):
        """What `montecarta analyze` says, as {name: pandas.DataFrame}: "cells" has verdicts, errors
        and costs, "families" the tests of each verdict, "consistency" the average NEES by every
        covariance, "series_LABEL" everything over time. `options` as for the command, e.g.
        "--within", "1.2"; without `program` it is that of program(). Raises
        subprocess.CalledProcessError where the program fails."""
        with tempfile.TemporaryDirectory() as folder:
            program = program or globals()["program"]()
            subprocess.run([program, "analyze", self.path, "--csv", folder, "--force", *options],
                           check=True, stdout=subprocess.DEVNULL)
            return {name.removesuffix(".csv"): _table(os.path.join(folder, name))
                    for name in sorted(os.listdir(folder))}

    def _has(self, name):
        import h5py

        with h5py.File(self.path, "r") as file:
            return name in file


def open(path):  # noqa: A001, the name that Python's own readers have
    """The result file `path` as Results. Raises OSError where it cannot be read, ValueError where
    it is none of ours."""
    return Results(path)


def arrays(path):
    """All datasets as nested dictionaries of NumPy arrays, axes as in FORMAT.md:
    arrays("out.h5")["cells"]["ekf_slam"]["pose_mean"][run, time, component]."""
    import h5py

    def read(group):
        return {name: read(item) if isinstance(item, h5py.Group) else item[()]
                for name, item in group.items()}

    with h5py.File(path, "r") as file:
        return read(file)


def at_scans(cell):
    """The complete runs of a cell at its scans: what is stored by time has the axis `scan`."""
    if "scan_row" not in cell:
        raise ValueError("each run has its scans at rows of its own (recorded drives with "
                         "record.rate = control): take the rows scan_step of "
                         "arrays(path)[\"scenario\"][\"drives\"]")
    rows = cell.scan_row.values
    cell = cell.isel(run=np.flatnonzero(cell.status.values == 1))

    def at(array):
        if "time" not in array.dims:
            return array
        array = array.isel(time=rows).rename(time="scan").drop_vars("scan", errors="ignore")
        return array.assign_coords(scan=cell.scan) if "scan" in cell.coords else array

    return cell.map(at, keep_attrs=True).drop_vars("time", errors="ignore")


def pose_error(truth, estimate):
    """estimate - truth, as STATISTICS (1.1) has it; heading in [-pi, pi]."""
    error = estimate - truth
    turns = np.round(error / (2 * np.pi))
    return error.where(error.component != "heading", error - 2 * np.pi * turns)


def _table(path):
    import pandas

    try:
        return pandas.read_csv(path)
    except pandas.errors.EmptyDataError:  # nothing to say: not even a heading
        return pandas.DataFrame()


def _plain(attributes):
    return {name: value.decode() if isinstance(value, bytes) else value
            for name, value in attributes.items()}
