# SPDX-License-Identifier: BSD-3-Clause
"""Reads montecarta result files (analysis/FORMAT.md): named arrays with units by xarray, tables by
pandas, or plain NumPy arrays. One file, to be copied; nothing else of montecarta is needed, but for
tables(), which the program computes.

    import montecarta

    results = montecarta.open("first_study.h5")
    results.labels                                  # ("ekf_slam", "fastslam1_m100", ...)
    cell = results["ekf_slam"]                      # xarray.Dataset, read where it is used
    cell.pose_mean.sel(component="x").sel(time=12.5, method="nearest")
    montecarta.at_scans(cell)                       # complete runs, at the scans
    results.tables()["cells"]                       # pandas.DataFrame, with the verdicts
"""
import os
import subprocess
import tempfile

import numpy as np

POSE = ["x", "y", "heading"]


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
        time and scan. `attrs` holds the filter and its settings. Raises KeyError where there is no
        such cell."""
        import xarray

        if label not in self.labels:
            raise KeyError(f"{self.path} has no cell {label!r}: it has {', '.join(self.labels)}")
        root = xarray.open_dataset(self.path, engine="netcdf4")
        cell = xarray.open_dataset(self.path, engine="netcdf4", group="cells/" + label)
        cell = cell.assign(scan_row=root.scan_row).assign_coords(run=root.run)
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

    def tables(self, program="montecarta", *options):
        """What `montecarta analyze` says, as {name: pandas.DataFrame}: "cells" has verdicts, errors
        and costs, "families" the tests of each verdict, "consistency" the average NEES by every
        covariance, "series_LABEL" everything over time. `options` as for the command, e.g.
        "--within", "1.2". Raises subprocess.CalledProcessError where the program fails."""
        with tempfile.TemporaryDirectory() as folder:
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
