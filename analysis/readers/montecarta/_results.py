# SPDX-License-Identifier: BSD-3-Clause
"""Result files (analysis/FORMAT.md), and the studies that write them."""
from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._program import program as _program

if TYPE_CHECKING:
    import h5py
    import pandas
    import xarray

POSE = ["x", "y", "heading"]


def run(study: str | os.PathLike[str], output: str | os.PathLike[str],
        settings: Mapping[str, Any] | None = None) -> Results:
    """Runs a study. Progress is shown where standard error is a terminal.

    Parameters
    ----------
    study : str
        A study file, or the name of a shipped one, e.g. "first_study".
    output : str
        The result file. An unfinished one is continued; one that is finished is kept.
    settings : dict, optional
        Changed settings, e.g. {"study.runs": 100}.

    Returns
    -------
    Results

    Raises
    ------
    subprocess.CalledProcessError
        If the program fails; it says why on standard error.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     results = run("first_study", os.path.join(folder, "first.h5"), {"study.runs": 3})
    >>> results.labels
    ('ekf_slam', 'fastslam1_m100', 'fastslam2_m100')
    """
    changes = [word for name, value in (settings or {}).items()
               for word in ("--set", f"{name}={value}")]
    output = os.fspath(output)
    unfinished = ["--resume"] if os.path.exists(f"{output}.part") else []
    if not os.path.exists(output) or unfinished:
        subprocess.run([_program(), "run", os.fspath(study), "-o", output, *changes, *unfinished],
                       check=True, stdout=subprocess.DEVNULL)
    return Results(output)


class Results:
    """A result file.

    Parameters
    ----------
    path : str
        The file.

    Attributes
    ----------
    labels : tuple of str
        Its cells, each of which is an xarray.Dataset: `results[label]`.
    attrs : dict
        Its own attributes: study, title, seed, runs.
    study : str
        The study file with everything filled in.
    scenario, provenance : dict
        What was simulated, and by which program.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no result file.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        import h5py

        self.path: str = os.fspath(path)
        with h5py.File(self.path, "r") as file:
            if file.attrs.get("filetype") not in ("montecarta-results", b"montecarta-results"):
                raise ValueError(f"{self.path}: no montecarta result file: name one that "
                                 "`montecarta run` wrote")
            self.labels: tuple[str, ...] = tuple(file["cells"])
            self.attrs = _plain(file.attrs)
            self.study: str = file["provenance/study"].asstr()[()]
            self.scenario = _plain(file["scenario"].attrs)
            self.provenance = _plain(file["provenance"].attrs)
            self._settings = {label: _plain(cell["settings"].attrs)
                              for label, cell in file["cells"].items()}

    def __iter__(self) -> Iterator[str]:
        return iter(self.labels)

    def __getitem__(self, label: str) -> xarray.Dataset:
        """One cell.

        Parameters
        ----------
        label : str
            One of `labels`.

        Returns
        -------
        xarray.Dataset
            Every dataset of the cell, `truth` and `truth_*` where true paths are stored,
            `scan_row`; coordinates run, time [s], scan [s], component (x [m], y [m], heading
            [rad]). Runs that are drives of their own have no common times: without the coordinates
            time and scan, and without scan_row where poses are stored between scans. `attrs` holds
            the filter and its settings.

        Raises
        ------
        KeyError
            If there is no such cell.
        """
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
            cell = cell.assign({"truth" if name == "pose" else f"truth_{name}": truth[name]
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

    def tables(self, program: str | None = None, *options: str) -> dict[str, pandas.DataFrame]:
        """What `montecarta analyze` says.

        Parameters
        ----------
        program : str, optional
            The path of the program; by default that of `montecarta.program`.
        *options : str
            As for the command, e.g. "--within", "1.2".

        Returns
        -------
        dict of str to pandas.DataFrame
            "cells" has verdicts, errors and costs, "families" the tests of each verdict,
            "consistency" the average NEES by every covariance, "series_LABEL" everything over time.
            Units are in the names of the columns.

        Raises
        ------
        subprocess.CalledProcessError
            If the program fails; it says why on standard error.
        """
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([program or _program(), "analyze", self.path, "--csv", folder, "--force",
                            *options], check=True, stdout=subprocess.DEVNULL)
            return {name.removesuffix(".csv"): _table(os.path.join(folder, name))
                    for name in sorted(os.listdir(folder))}

    def _has(self, name: str) -> bool:
        import h5py

        with h5py.File(self.path, "r") as file:
            return name in file


def open(path: str | os.PathLike[str]) -> Results:  # noqa: A001, as other readers call it
    """Opens a result file.

    Parameters
    ----------
    path : str
        The file.

    Returns
    -------
    Results

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no result file.
    """
    return Results(path)


def arrays(path: str | os.PathLike[str]) -> dict[str, Any]:
    """All datasets of an HDF5 file.

    Parameters
    ----------
    path : str
        The file.

    Returns
    -------
    dict
        Nested dictionaries of NumPy arrays, with axes and units as in FORMAT.md:
        arrays("out.h5")["cells"]["ekf_slam"]["pose_mean"][run, time, component].
    """
    import h5py

    def read(group: h5py.Group) -> dict[str, Any]:
        return {name: read(item) if isinstance(item, h5py.Group) else item[()]
                for name, item in group.items()}

    with h5py.File(path, "r") as file:
        return read(file)


def at_scans(cell: xarray.Dataset) -> xarray.Dataset:
    """The complete runs of a cell, at its scans.

    Parameters
    ----------
    cell : xarray.Dataset
        A cell of `Results`.

    Returns
    -------
    xarray.Dataset
        The same, in which what is stored by time has the axis `scan` [s] instead.

    Raises
    ------
    ValueError
        If each run has its scans at rows of its own.
    """
    if "scan_row" not in cell:
        raise ValueError("each run has its scans at rows of its own (recorded drives with "
                         "record.rate = control): take the rows scan_step of "
                         "arrays(path)[\"scenario\"][\"drives\"]")
    rows = cell.scan_row.values
    cell = cell.isel(run=np.flatnonzero(cell.status.values == 1))

    def at(array: xarray.DataArray) -> xarray.DataArray:
        if "time" not in array.dims:
            return array
        array = array.isel(time=rows).rename(time="scan").drop_vars("scan", errors="ignore")
        return array.assign_coords(scan=cell.scan) if "scan" in cell.coords else array

    return cell.map(at, keep_attrs=True).drop_vars("time", errors="ignore")


def pose_error(truth: xarray.DataArray, estimate: xarray.DataArray) -> xarray.DataArray:
    """The error of poses, as STATISTICS (1.1) has it.

    Parameters
    ----------
    truth, estimate : xarray.DataArray, {..., component}
        Poses x [m], y [m], heading [rad].

    Returns
    -------
    xarray.DataArray, {..., component}
        estimate - truth [m, m, rad], the heading in [-pi, pi].
    """
    error: xarray.DataArray = estimate - truth
    turns = np.round(error / (2 * np.pi))
    wrapped: xarray.DataArray = error - 2 * np.pi * turns
    return error.where(error.component != "heading", wrapped)


def _table(path: str) -> pandas.DataFrame:
    import pandas

    try:
        return pandas.read_csv(path)
    except pandas.errors.EmptyDataError:  # nothing to say: not even a heading
        return pandas.DataFrame()


def _plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value.decode() if isinstance(value, bytes) else value
            for name, value in attributes.items()}
