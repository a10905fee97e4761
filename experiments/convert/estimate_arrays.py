# SPDX-License-Identifier: BSD-3-Clause
"""Reads the estimates of many runs from arrays in one .npz file or one MATLAB file: `mean` {run,
scan, column} or `error` {run, scan, d}, `covariance` {run, scan, d, d}, `truth` {run, scan, column}
or {scan, column}; optional `time` {scan} or {run, scan} and `names` {column}, or one text with
commas; `nis` and `nis_dof` {run, scan}, which arrays.py writes. NaN is missing.
"""
import os

import conversion
from conversion import ConversionError, np
from covariance_columns import in_order
from estimate_layouts import POSE_COLUMNS, Run
from estimate_table import seconds

KNOWN = ("mean", "error", "covariance", "truth", "time", "names", "nis", "nis_dof")
MATLAB_HDF5 = b"MATLAB 7.3"  # a file of version 7.3 begins with it
OF_OBJECT = ("s0", "s1", "s2", "arr")  # SciPy's record of an object of MATLAB: name, system, class


class Arrays:
    """The arrays of one file, with the axes that MATLAB leaves out if they have one entry."""

    def __init__(self, path):
        self.path = path
        self.members = []  # names of all arrays in the file, also of unknown ones
        if not path.lower().endswith(".mat"):
            self.variables = self._npz(path)
        else:
            self.variables = self._hdf5(path) if is_matlab_hdf5(path) else self._mat(path)

    def _npz(self, path):
        try:
            with open(path, "rb") as file:
                stored = np.load(file, allow_pickle=False)
                self.members = stored.files
                return {name: stored[name] for name in KNOWN if name in stored}
        except Exception as fault:  # NumPy raises various errors for a damaged file
            if isinstance(fault, OSError) and not os.access(path, os.R_OK):
                raise ConversionError(f"{path}: cannot be opened ({fault.strerror}): check the "
                                      "path and its permissions") from None
            raise ConversionError(f"{path}: is damaged or no .npz of numbers ({fault}): save it by "
                                  "numpy.savez, without objects") from None

    def _mat(self, path):
        """The variables of a MATLAB file up to version 7. Of an object, SciPy has a record that
        names the variable and its class."""
        variables = conversion.MatFile(path).variables
        self.members = [name for name in variables if not name.startswith("__")]
        for value in variables.values():
            if not isinstance(value, np.ndarray) or value.dtype.names != OF_OBJECT:
                continue
            name, kind = (bytes(value[0][part]).decode() for part in ("s0", "s2"))
            if name in KNOWN and kind == "string":
                refuse_string_object(path, name)
        return variables

    def _hdf5(self, path):
        """The variables of a MATLAB file of version 7.3, which has their axes turned round."""
        try:
            import h5py
        except ImportError:
            raise ConversionError(f"{path}: a MATLAB file of version 7.3 (h5py reads it): install "
                                  "python3-h5py, or save it with -v7") from None
        try:
            with h5py.File(path, "r") as file:
                self.members = list(file)
                found = {name: file[name] for name in KNOWN if name in file}
                return {name: matlab_variable(file, stored, name)
                        for name, stored in found.items()}
        except (OSError, KeyError, RuntimeError, TypeError, ValueError, AttributeError) as fault:
            raise ConversionError(f"{path}: is damaged or no MATLAB file ({fault}): save it "
                                  "again") from None

    def get(self, name, axes):
        """The array as doubles, or None. `axes` are the counts of axes that it may have."""
        values = self.variables.get(name)
        if values is None:
            return None
        if not isinstance(values, np.ndarray) or values.dtype.kind not in "iuf":
            raise ConversionError(f"{self.path}: '{name}' is no array of real numbers: save it so")
        if values.ndim < min(axes):
            values = values.reshape(values.shape + (1,) * (min(axes) - values.ndim))
        if values.ndim not in axes:
            raise ConversionError(f"{self.path}: '{name}' has {values.ndim} axes (it needs "
                                  f"{' or '.join(map(str, axes))}, the last of the state): save "
                                  "it so")
        return values

    def states(self):
        """The name and the values of the states: `mean` or `error`."""
        found = {name: self.get(name, (3,)) for name in ("mean", "error")}
        given = [name for name, values in found.items() if values is not None]
        if len(given) == 1:
            return given[0], found[given[0]]
        there = ", ".join(sorted(self.members))
        fault = ("both 'error' and 'mean' (one of them is judged)" if given else
                 f"neither 'error' nor 'mean' (the file has {there[:200] or 'no array'})")
        raise ConversionError(f"{self.path}: {fault}: save mean, covariance and truth, or error "
                              "and covariance")

    def name_texts(self):
        """The texts of `names`, or None."""
        given = self.variables.get("names")
        if given is None:
            return None
        texts = [str(np.ravel(name)[0] if np.size(name) else "") for name in np.ravel(given)]
        return texts[0].split(",") if len(texts) == 1 else texts

    def names(self, count, is_error):
        """Names of the state's columns; without `names`, they are numbered."""
        prefix = "error_" if is_error else ""
        texts = self.name_texts()
        if texts is None:
            return tuple(f"{prefix or 'state_'}{k}" for k in range(count)), [
                "no names: no component is wrapped as an angle (names = x_m, heading_rad, ...)"]
        names = tuple(prefix + text.strip() for text in texts)
        if len(names) != count or not all(name[len(prefix):] for name in names):
            raise ConversionError(f"{self.path}: 'names' has {len(names)} names of {count} columns "
                                  "(each has one): save one for each column")
        return names, []

    def times(self, run, runs, scans):
        """Times of a run's scans, as words; the number of the scan without `time`."""
        values = self.variables.get("time")
        if values is None:
            return [str(k) for k in range(scans)]
        values = np.asarray(values)
        if values.dtype.kind not in "iuf" or values.size not in (scans, runs * scans):
            raise ConversionError(f"{self.path}: 'time' is {values.shape} (it is {{scan}} or "
                                  f"{{run, scan}}, here {scans} or {runs} x {scans}): save it so")
        own = values.ravel() if values.size == scans else values.reshape(runs, scans)[run]
        return [str(one) if values.dtype.kind in "iu" else repr(float(one)) for one in own]


def is_matlab_hdf5(path):
    try:
        with open(path, "rb") as file:
            return file.read(len(MATLAB_HDF5)) == MATLAB_HDF5
    except OSError:
        return False  # which reading it will say


def refuse_string_object(path, name):
    raise ConversionError(f"{path}: '{name}' is an object of MATLAB's class string (only MATLAB "
                          "reads it): write 'x_m,y_m' in single quotes, and save it again")


def matlab_variable(file, stored, name):
    """An array as MATLAB has it: numbers, a text, or a list of the texts of a cell array."""
    kind = stored.attrs.get("MATLAB_class", b"double")
    if kind == b"char":
        return "".join(map(chr, np.asarray(stored).ravel()))
    if kind == b"cell":
        return [matlab_variable(file, file[one], name) for one in np.asarray(stored).ravel()]
    if kind == b"string":
        refuse_string_object(file.filename, name)
    return np.asarray(stored).T


def check_shape(arrays, name, found, wanted):
    if found != wanted:
        raise ConversionError(f"{arrays.path}: '{name}' is {' x '.join(map(str, found))}, but "
                              f"{' x '.join(map(str, wanted))} was expected (axes are run, scan, "
                              "state): save it so")


def runs_in(path, options):
    """[(number of the run, Run)] in a file of arrays; the number is None for a truth of all."""
    arrays = Arrays(path)
    kind, values = arrays.states()
    runs, scans, width = values.shape
    names, notes = arrays.names(width, kind == "error")
    if "time" not in arrays.variables:
        notes.append("no time: scans are numbered 0, 1, 2, ... s")
    layout = f"arrays, since it has {kind} {{run, scan, column}}"

    def run_of(number, states, covariances):
        return one_run(arrays, Run(path, layout, names, [], [], states, covariances, notes),
                       arrays.times(number or 0, runs, scans), number, options)

    if options.kind == "estimate":
        d = 6 if set(names) == set(POSE_COLUMNS) else width
        covariance = arrays.get("covariance", (4,))
        if covariance is None:
            raise ConversionError(f"{path}: no 'covariance' (without it nothing can be judged): "
                                  "save it as {run, scan, d, d}")
        check_shape(arrays, "covariance", covariance.shape, (runs, scans, d, d))
        if options.order and d == width:
            raise ConversionError(f"{path}: --order {options.order} (the order of the covariance "
                                  f"must be that of {','.join(names)} here; only a 'mean' of poses "
                                  "in space may have another): leave it out")
        return [(k, run_of(k, values[k], in_order(covariance[k], options))) for k in range(runs)]
    if kind == "error":
        raise ConversionError(f"{path}: 'error' needs no truth (an error is a difference from it): "
                              "judge the estimates without --truth")
    truth = arrays.get("truth", (2, 3))
    if truth is None:
        raise ConversionError(f"{path}: no 'truth' (that of 'mean' is needed): save it as {{run, "
                              "scan, column}}")
    if truth.ndim == 3:
        check_shape(arrays, "truth", truth.shape, values.shape)
        return [(k, run_of(k, truth[k], None)) for k in range(runs)]
    check_shape(arrays, "truth", truth.shape, (scans, width))
    if np.size(arrays.variables.get("time", 0)) > scans:  # a run has times of its own
        return [(k, run_of(k, truth, None)) for k in range(runs)]
    return [(None, run_of(None, truth, None))]


def one_run(arrays, run, words, number, options):
    """The run without the scans whose whole state is NaN. Anything else that is not finite is
    refused."""
    states, covariances = run.states, run.covariances
    place = f"{arrays.path}: run {number or 0}"
    kept = np.flatnonzero(~np.isnan(states).all(axis=1))
    for k in kept:
        if not np.isfinite(states[k]).all() or (
                covariances is not None and not np.isfinite(covariances[k]).all()):
            raise ConversionError(f"{place}, scan {k}: partly NaN or infinite (a missing scan is "
                                  "NaN in the whole state): correct it")
    places = [f"{place}, scan {k}" for k in kept]
    times, said = seconds([words[k] for k in kept], places, "", options.time)
    if options.kind == "truth" and not times:
        raise ConversionError(f"{place}: a truth of no time (it is NaN everywhere): save one")
    missing = len(states) - len(kept)
    notes = [*run.notes, *said, *(["scans that are NaN are left out"] if missing else [])]
    return Run(run.path, run.layout, run.columns, places, times, states[kept],
               None if covariances is None else covariances[kept], notes)
