# SPDX-License-Identifier: BSD-3-Clause
"""Judging the estimates of another program, which are arrays."""
from __future__ import annotations

import functools
import html
import json
import os
import re
import shutil
import tempfile
import weakref
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._program import call
from ._results import Results

if TYPE_CHECKING:
    import h5py
    import pandas
    from numpy.typing import ArrayLike, NDArray

_BLOCK = 8 * 2**20  # numbers that are converted at a time


class Ratio(NamedTuple):
    """A ratio of squared errors to the expected ones [1], with its 95 % interval; 1 is right."""

    estimate: float
    lower: float
    upper: float

    def __str__(self) -> str:
        return f"{self.estimate:.3g} [{self.lower:.3g}, {self.upper:.3g}]"


class Block(NamedTuple):
    """The verdict on some components of a state by themselves."""

    answer: str   # as that of a Judgement
    ratio: Ratio

    def __str__(self) -> str:
        return f"{self.answer}, NEES ratio {self.ratio}"


class Inconsistent(AssertionError):
    """An estimator is shown not to be consistent."""


class Judgement:
    """The verdict on an estimator (analysis/STATISTICS.md, chapter 5).

    Parameters
    ----------
    path : str
        A result file with one cell.
    notes : sequence of str, optional
        See the attribute.
    within : float, optional
        Margin [1]; by default the one with which the file was judged.

    Attributes
    ----------
    answer : str
        "consistent" within the margin, "optimistic", "conservative", "inconsistent", "undecided" or
        "untested". The errors decide it; innovations have a ratio of their own, `nis`.
    sentence : str
        The answer in words, with what was shown.
    ratio : Ratio
        Mean of the squared errors in units of their covariance [1], with its interval; NaN if
        nothing could be tested.
    components : dict of str to Ratio
        The ratio of each component by itself; empty if there is only one.
    blocks : dict of str to Block
        The same of position, rotation or heading, and velocity by themselves, where the names of
        the components tell which is which.
    runs, missing, unusable : int
        Numbers of runs, of samples without an estimate, and of samples whose covariance is none.
    notes : list of str
        What is likely a mistake in the input.
    path : str
        The result file, which `open` reads and `montecarta report` draws.
    """

    def __init__(self, path: str | os.PathLike[str], notes: Sequence[str] = (),
                 within: float | None = None) -> None:
        self._margin = [] if within is None else ["--within", str(within)]
        self._json = json.loads(call("gate", os.fspath(path), "--json", *self._margin).stdout)
        self.path: str = os.fspath(path)
        self.runs: int = self._json["runs"]
        self.missing: int = self._json["missing"]
        self.unusable: int = self._json["unusable"]
        self.notes: list[str] = list(notes)
        self.answer: str = self._json["verdict"]
        self.sentence: str = self._json["reason"]
        self.ratio = next((_ratio_of(test["members"][0]) for test in self._json["families"]
                           if test["family"] == "size"), Ratio(np.nan, np.nan, np.nan))
        self.components = {member["name"]: _ratio_of(member) for test in self._json["families"]
                           if test["family"] == "component" for member in test["members"]}
        self.blocks = {block["name"]: Block(block["verdict"], _ratio_of(block))
                       for block in self._json["blocks"]}

    @property
    def families(self) -> pandas.DataFrame:
        """The tests of the verdict.

        Returns
        -------
        pandas.DataFrame
            One row for each member of a family: `estimate` with its 95 % interval `lower` to
            `upper`, `p` of the member and `family_p` of the family [1]. `shown` says whether it is
            part of the verdict. Of the scans only the one with the smallest p-value is there.
        """
        import pandas

        rows = [(test["family"], member["name"], *_ratio_of(member), member["p"], test["p"],
                 member["shown"]) for test in self._json["families"] for member in test["members"]]
        numbers = ["estimate", "lower", "upper", "p", "family_p"]
        table = pandas.DataFrame(rows, columns=["family", "member", *numbers, "shown"])
        return table.astype({name: float for name in numbers})

    @functools.cached_property
    def nis(self) -> Ratio:
        """The ratio of innovations, which is no part of the verdict.

        Returns
        -------
        Ratio
            Mean of the normalised innovations squared for each of their components [1]; NaN if
            there are none.
        """
        cell = self.tables()["cells"].iloc[0]
        return Ratio(*(float(cell.get("nis_per_component" + end, np.nan))
                       for end in ("", "_lower", "_upper")))

    def tables(self) -> dict[str, pandas.DataFrame]:
        """All tables of `montecarta analyze` (see `Results.tables`).

        Returns
        -------
        dict of str to pandas.DataFrame
        """
        return Results(self.path).tables(None, *self._margin)

    def report(self, folder: str | os.PathLike[str]) -> str:
        """Writes a page with figures.

        Parameters
        ----------
        folder : str
            Its folder, which is made, or whose earlier page is replaced.

        Returns
        -------
        str
            The path of the page. Figures need gnuplot.
        """
        call("report", self.path, "-o", os.fspath(folder), "--force", *self._margin)
        return os.path.join(folder, "index.html")

    def raise_if_inconsistent(self) -> None:
        """Refuses an estimator that is wrong. Too few runs to decide are no error.

        It also passes where `sentence` says "slightly optimistic" (`answer` is "optimistic" then):
        a deviation is shown, and not that it is beyond the margin.

        Raises
        ------
        Inconsistent
            An AssertionError with the sentence, if the estimator is shown not to be consistent
            within the margin, or if nothing could be judged.
        """
        __tracebackhide__ = True  # pytest shows the line of the test
        if self._json["gate"] == "inconsistent" or self.answer == "untested":
            raise Inconsistent(repr(self))

    def raise_unless_consistent(self) -> None:
        """Refuses an estimator that is not shown to be right.

        It passes where `answer` is "consistent", even with a deviation that is shown to lie within
        the margin ("consistent within 1.1, slightly optimistic").

        Raises
        ------
        Inconsistent
            An AssertionError with the sentence, unless the estimator is shown to be consistent
            within the margin: also if too few runs were judged to decide.
        """
        __tracebackhide__ = True
        if self._json["gate"] != "consistent":
            raise Inconsistent(repr(self))

    def __repr__(self) -> str:
        blocks = (f"  {name}: {block}" for name, block in self.blocks.items())
        return "\n".join([self.sentence, *blocks, *("note: " + note for note in self.notes)])

    def _repr_html_(self) -> str:
        colour = {"consistent": "#2a7d3f", "undecided": "#777", "untested": "#777"}
        members = {} if np.isnan(self.ratio.estimate) else {"all": self.ratio}
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{ratio}</td></tr>"
                       for name, ratio in (members | self.components).items())
        rows += "".join(f"<tr><td>{html.escape(name)}: {block.answer}</td><td>{block.ratio}</td>"
                        "</tr>" for name, block in self.blocks.items())
        notes = "".join(f"<li>{html.escape(note)}</li>" for note in self.notes)
        return (f"<p><b style='color:{colour.get(self.answer, '#b3261e')}'>{self.answer}</b><br>"
                f"{html.escape(self.sentence)}</p>"
                + (f"<table><tr><th></th><th>NEES ratio [95 %]</th></tr>{rows}</table>"
                   if rows else "") + (f"<ul>{notes}</ul>" if notes else ""))


def _ratio_of(member: dict[str, Any]) -> Ratio:
    return Ratio(*(np.nan if number is None else float(number)
                   for number in (member["estimate"], *member["interval"])))


def judge(errors: ArrayLike, covariances: ArrayLike, times: ArrayLike | None = None,
          nis: ArrayLike | None = None, names: str | Sequence[str] | None = None,
          within: float = 1.1, *, nis_dof: ArrayLike | None = None,
          components: Sequence[str] | None = None,
          path: str | os.PathLike[str] | None = None) -> Judgement:
    """Judges the errors of an estimator by the covariances that it states.

    Parameters
    ----------
    errors : array_like, {run, scan, d}, or {scan, d} of one run
        Estimate minus truth, in the frame and chart of the covariance, each in the unit of its
        component. Runs are independent. A scan whose errors are all NaN, or masked, is missing. A
        run that ends before the others has failed.
    covariances : array_like, {run, scan, d, d}, or {scan, d, d} if all runs have the same
        The covariance that the estimator stated for each error [products of the units].
    times : array_like, {scan} or {run, scan}, optional
        Times [s]; by default the numbers of the scans.
    nis, nis_dof : array_like, {run, scan}, or {scan} of one run, optional
        Normalised innovations squared [1], and their numbers of components (an array or one
        number), whose ratio is `Judgement.nis`. NaN where nothing was observed.
    names : sequence of str, {d}, or a str with commas, optional
        Names of the components, with a unit, e.g. ["x_m", "heading_rad"]. Those of a pose in space
        are x_m, y_m, z_m, rx_rad, ry_rad, rz_rad; then `Judgement.blocks` has position and
        rotation.
    within : float, optional
        Margin [1]: ratios of squared errors from 1 / within to within are consistent.
    components : sequence of str, optional
        Judge these components only, by their names without the unit, e.g. ["x"].
    path : str, optional
        Where to keep the result file, which replaces an earlier one. By default it is in the folder
        of temporary files (TMPDIR), about as large as the arrays, as long as the judgement is held.

    Returns
    -------
    Judgement

    Raises
    ------
    ValueError
        If arrays do not fit or cannot be judged, with the reason and a remedy.
    FileNotFoundError
        If there is no program (see `program`).
    RuntimeError
        If the program fails, e.g. because the disk is full.

    Examples
    --------
    >>> import numpy as np
    >>> errors = np.random.default_rng(1).standard_normal((300, 100, 2))
    >>> judge(errors, np.broadcast_to(np.eye(2), (300, 100, 2, 2))).answer
    'consistent'
    >>> judge(errors, np.broadcast_to(0.8 * np.eye(2), (300, 100, 2, 2))).answer
    'optimistic'
    >>> judge(errors, np.eye(2))
    Traceback (most recent call last):
        ...
    ValueError: covariances has the shape (2, 2): expected {run, scan, d, d} = (300, 100, 2, 2) or \
{scan, d, d} = (100, 2, 2), as errors has the shape (300, 100, 2)
    """
    states = _States("errors", errors)
    d = states.array.shape[2]
    arrays = {"error": states.array} | _beside(states, d, covariances, times, nis, nis_dof)
    if names is not None:
        states.require_names(names)
    return _judge(arrays, names, components, within, path, [])


def judge_estimates(estimates: ArrayLike, truths: ArrayLike, covariances: ArrayLike,
                    error: str | None = None, times: ArrayLike | None = None,
                    nis: ArrayLike | None = None,
                    names: str | Sequence[str] = ("x_m", "y_m", "heading_rad"),
                    within: float = 1.1, *, nis_dof: ArrayLike | None = None,
                    components: Sequence[str] | None = None, anchor: str | None = None,
                    path: str | os.PathLike[str] | None = None) -> Judgement:
    """Judges estimates by their truths, of poses by the error that the covariance describes.

    Parameters
    ----------
    estimates : array_like, {run, scan, column}, or {scan, column} of one run
        States in the order of `names` [m, rad, or the unit of the name]. A scan that is all NaN, or
        masked, is missing.
    truths : array_like, like `estimates`, or {scan, column} of all runs
        True states.
    covariances : array_like, {run, scan, d, d}, or {scan, d, d} if all runs have the same
        Covariances [products of the units of the components], for poses position first.
    error : str, optional
        "world", "body", "right-invariant", "left-invariant" or, in space, "world-body": the error
        of the covariance of a pose (`montecarta judge --help`). Needed for poses.
    names : sequence of str, {column}, or a str with commas
        Columns of the state. ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"] is a pose in space; its
        covariance has d = 6 components.
    anchor : str, optional
        "first", "yaw" or "se3": what of each truth is moved onto the first estimate of its run:
        position, position and heading, or position and rotation. It is for estimates that start in
        a frame of their own, with a first covariance near 0; else moved errors are judged by an
        upper bound. Without it nothing is moved.

    Returns
    -------
    Judgement

    See Also
    --------
    judge : has the other parameters, and the exceptions.

    Examples
    --------
    >>> import numpy as np
    >>> noise = 0.1 * np.random.default_rng(1).standard_normal((300, 100, 3))
    >>> truths = np.linspace([0, 0, 0], [50, 20, 3], 100)
    >>> covariances = np.broadcast_to(0.01 * np.eye(3), (100, 3, 3))
    >>> judge_estimates(truths + noise, truths, covariances, error="world").answer
    'consistent'
    """
    states, true_states = _States("estimates", estimates), _numbers("truths", truths)
    states.require("truths", true_states, ["run scan column", "scan column"])
    states.require_names(names)
    lost = ~np.isnan(states.array).all(-1) & np.isnan(true_states).all(-1)
    if lost.any():
        run, scan = np.argwhere(lost)[0]
        raise ValueError(f"truths is NaN at run {run}, scan {scan}, and estimates is not: give the "
                         "true state of each estimate")
    d = int(np.shape(covariances)[-1]) if np.ndim(covariances) > 0 else 0
    arrays = {"mean": states.array, "truth": true_states} | _beside(
        states, d, covariances, times, nis, nis_dof)
    options = [] if error is None else ["--error", error]
    options += [] if anchor is None else ["--anchor", anchor]
    return _judge(arrays, names, components, within, path, options)


def _numbers(name: str, values: ArrayLike) -> NDArray[Any]:
    """An array of real numbers, which is not copied if it is one already. Masked ones are NaN."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.where(values.mask, np.nan, values.data)
    try:
        array = np.asarray(values)
        if array.dtype == object:
            array = array.astype(float)
    except (TypeError, ValueError) as why:
        raise ValueError(f"{name} is no array of numbers ({why}): give arrays of equal lengths, "
                         "with NaN where something is missing") from None
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} has elements of the type {array.dtype}: give real numbers, times "
                         "in s")
    return array


class _States:
    """Errors or states {run, scan, column}, whose shape the other arrays must fit."""

    def __init__(self, name: str, values: ArrayLike) -> None:
        array = _numbers(name, values)
        self.said = f"{name} has the shape {array.shape}"
        if array.ndim not in (2, 3) or array.size == 0:
            raise ValueError(f"{self.said}: expected {{run, scan, d}}, or {{scan, d}} of one run, "
                             "with a number at least")
        if np.isnan(array).all():
            raise ValueError(f"{name} is NaN everywhere: give at least one scan")
        self.array = array if array.ndim == 3 else array[np.newaxis]

    def require(self, name: str, array: NDArray[Any], shapes: Sequence[str], d: int = 0) -> None:
        """Raises ValueError unless an array has one of the shapes, which name their axes."""
        sizes = dict(zip(("run", "scan", "column"), self.array.shape)) | {"d": d}
        expected = {axes: tuple(sizes[axis] for axis in axes.split()) for axes in shapes}
        if array.shape not in expected.values():
            texts = [f"{{{axes.replace(' ', ', ')}}} = {shape}" for axes, shape in expected.items()]
            raise ValueError(f"{name} has the shape {array.shape}: expected {' or '.join(texts)}, "
                             f"as {self.said}")

    def require_names(self, names: str | Sequence[str] | None) -> None:
        """Raises ValueError unless there is a name for each column."""
        given = [] if names is None else names
        listed = given.split(",") if isinstance(given, str) else [str(name) for name in given]
        if len(listed) != self.array.shape[2]:
            raise ValueError(f"names has {len(listed)} names ({', '.join(listed)}): expected "
                             f"{self.array.shape[2]}, as {self.said}")


def _beside(states: _States, d: int, covariances: ArrayLike, times: ArrayLike | None,
            nis: ArrayLike | None, nis_dof: ArrayLike | None) -> dict[str, NDArray[Any]]:
    """The arrays of the file beside errors or states."""
    runs, scans = states.array.shape[:2]
    P = _numbers("covariances", covariances)
    states.require("covariances", P, ["run scan d d", "scan d d"], d)
    beside = {"covariance": np.broadcast_to(P, (runs, scans, d, d))}
    if times is not None:
        beside["time"] = _numbers("times", times)
        states.require("times", beside["time"], ["scan", "run scan"])
    if (nis is None) != (nis_dof is None):
        raise ValueError("nis and nis_dof, the number of components of each, need each other: give "
                         "both or none")
    if nis is not None and nis_dof is not None:
        shapes = ["run scan", "scan"] if runs == 1 else ["run scan"]
        for name, values in [("nis", _numbers("nis", nis)),
                             ("nis_dof", _numbers("nis_dof", nis_dof))]:
            if name == "nis" or values.ndim > 0:
                states.require(name, values, shapes)
            beside[name] = np.broadcast_to(values, (runs, scans))
    return beside


def comma_joined(names: str | Sequence[str]) -> str:
    """The names as one text with commas, which a text is already."""
    return names if isinstance(names, str) else ",".join(map(str, names))


def _judge(arrays: dict[str, NDArray[Any]], names: str | Sequence[str] | None,
           components: Sequence[str] | None, within: float,
           path: str | os.PathLike[str] | None, options: list[str]) -> Judgement:
    try:
        import h5py
    except ImportError as missing:
        raise ImportError("judging arrays needs h5py: install python3-h5py (Debian), or h5py by "
                          "pip") from missing
    if components is not None:
        options += ["--components", comma_joined(components)]
    folder = tempfile.mkdtemp(prefix="montecarta-")
    try:
        given = os.path.join(folder, "estimates.h5")
        result = os.path.join(folder, "result.h5") if path is None else os.fspath(path)
        with h5py.File(given, "w") as file:
            for name, values in arrays.items():
                _write(file, name, values)
            if names is not None:
                file.attrs["names"] = comma_joined(names)
        try:
            done = call("judge", given, "-o", result, "--force", "--cell", "estimator", "--within",
                        str(within), *options)
            os.remove(given)
            judgement = Judgement(result, [_of_arrays(note, folder)
                                           for note in done.stderr.splitlines()
                                           if note.startswith("montecarta: note: ")])
        except ValueError as error:
            raise ValueError(_of_arrays(str(error), folder)) from None
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(judgement, shutil.rmtree, folder, True)
    return judgement


def _write(file: h5py.File, name: str, values: NDArray[Any]) -> None:
    """Writes an array, converted in blocks, so that there is no second one in memory."""
    dataset = file.create_dataset(name, values.shape, np.float64)
    rows = max(1, _BLOCK // max(1, values[0].size))
    for first in range(0, len(values), rows):
        dataset[first:first + rows] = np.asarray(values[first:first + rows], np.float64)


def _of_arrays(text: str, folder: str) -> str:
    """A message of the program in terms of arrays: without the files of a folder, and without the
    dashes of options."""
    given, result = (re.escape(os.path.join(folder, name + ".h5"))
                     for name in ("estimates", "result"))
    of_run = given + r" \(((?:truth of )?run \d+), scan\)"
    text = re.sub(of_run + r":(\d+)", r"\1, scan \2", text)
    text = re.sub(of_run, r"\1", text)
    text = re.sub(f"^montecarta: note: |^judge: |{given}: |{result}: |cell estimator: ", "", text)
    return re.sub(r"--(error|within|components)\b", r"\1", text)
