# SPDX-License-Identifier: BSD-3-Clause
"""Reads a montecarta result file (analysis/FORMAT.md): plain arrays by h5py, or named ones by xarray."""
import h5py


def load_results(path):
    """All datasets as nested dictionaries, axes as in FORMAT.md:
    load_results("out.h5")["cells"]["ekf_slam"]["pose_mean"][run, time, component]."""

    def read(group):
        return {name: read(item) if isinstance(item, h5py.Group) else item[()] for name, item in group.items()}

    with h5py.File(path, "r") as file:
        return read(file)


def load_cell(path, label):
    """One cell and the truth as an xarray.Dataset, read from the disk where it is used:
    load_cell("out.h5", "ekf_slam").pose_mean.sel(time=12.5, method="nearest").mean("run")."""
    import xarray

    root = xarray.open_dataset(path)
    cell = xarray.open_dataset(path, group="cells/" + label)
    truth = xarray.open_dataset(path, group="truth").pose
    return cell.assign(truth=truth, scan_row=root.scan_row).assign_coords(run=root.run, time=root.time, scan=root.scan)
