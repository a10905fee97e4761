# SPDX-License-Identifier: BSD-3-Clause
"""Readers of text files in which other programs write poses in space and their covariances. The
columns are known by the header or, without one, by the count of numbers and by checks that can
fail. What stays ambiguous is refused, with the option that decides it.
"""
import dataclasses
import os

from conversion import ConversionError, np
from covariance_columns import (ALL_ZERO, ZERO_BETWEEN, covariances_named, family_in, from_triangle,
                                in_asked_order, in_order, is_deviation, refuse_order,
                                refuse_unknown, whole_covariances)
from estimate_table import CNSPY_ERRORS, POSE, SAME_TIME, SECONDS_IN, Table, pose_name, seconds

POSE_COLUMNS = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
QUATERNION_SLACK = 2e-3  # tolerance of its length, if printed with three digits


@dataclasses.dataclass
class Run:
    """Estimates or truth of one run. Without covariances in the file, `covariances` is None."""
    path: str
    layout: str              # the layout and why it was taken
    columns: tuple           # of the state
    places: list             # {row} "FILE:LINE"
    times: list              # {row} seconds, exact
    states: np.ndarray       # {row, column}
    covariances: np.ndarray  # {row, d, d}
    notes: list              # what the user should know of the conversion
    assumed: list = dataclasses.field(default_factory=list)  # what no check can tell, was guessed


def rotations(quaternions):
    """The rotation matrices {row, 3, 3} of quaternions qx, qy, qz, qw."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    return np.moveaxis(np.array(
        [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]), 2, 0)


def turned_into_map(poses, P):
    """Covariances {row, 6, 6} under the convention `world` from those of the position in the map
    and of the rotation in the frame of the estimated body, Log(R_truth' R_mean)."""
    turn = np.zeros((len(P), 6, 6))
    turn[:, :3, :3] = np.eye(3)
    turn[:, 3:, 3:] = rotations(poses[:, 3:])
    turned = turn @ P @ np.swapaxes(turn, 1, 2)
    return (turned + np.swapaxes(turned, 1, 2)) / 2


def poses_of(table, columns, options):
    """The poses {row, 7}, qw last, and a note if --quaternion decided."""
    if options.quaternion:
        quaternion = sorted(columns[3:])
        first_is_w = options.quaternion == "wxyz"
        columns = columns[:3] + (quaternion[1:] + quaternion[:1] if first_is_w else quaternion)
    poses = table.numbers(columns)
    for k, length in enumerate(np.linalg.norm(poses[:, 3:], axis=1)):
        if not abs(length - 1.0) <= QUATERNION_SLACK:
            raise ConversionError(f"{table.places[k]}: the quaternion has length {length:g} (of a "
                                  "rotation it is 1): write a unit quaternion; the header names "
                                  "the order of its columns")
    return poses, [f"quaternion {options.quaternion} by --quaternion"] if options.quaternion else []


def cnspy_convention(table, poses, P, notes):
    """The covariances of cnspy under the kind of error that the file declares, if it does."""
    declared = dict(table.declared)
    for key, name in (("TYPE", "est_err_type"), ("CHART", "err_representation")):
        if name in table.names:
            words = {row[table.names.index(name)].lower() for row in table.rows}
            if len(words) > 1:
                raise ConversionError(f"{table.path}: several values of {name} (all rows have one "
                                      "error): write a file for each")
            declared[key] = "".join(words)
    if "degree" in declared.get("CHART", ""):
        raise ConversionError(f"{table.header_place}: covariances in degrees (angles are in rad): "
                              "write radians")
    kind = declared.get("TYPE", "")
    if kind not in CNSPY_ERRORS:
        notes.append("the file does not say to which error the covariance belongs: choose --error")
        return P
    notes.append(f"{kind}: judge it by --error {CNSPY_ERRORS[kind]}")
    return turned_into_map(poses, P) if kind == "type5" else P


def read_under_header(table, options):
    """A pose in space under a header."""
    columns = [table.column(name) for name in POSE]
    if None in columns:
        raise ConversionError(f"{table.header_place}: no column {POSE[columns.index(None)]} (a "
                              "pose in space has a time, x, y, z, qx, qy, qz, qw): add it, named "
                              "as in TUM, EuRoC, ROS or cnspy")
    times, notes = seconds(*time_words(table), options.time)
    poses, said = poses_of(table, columns, options)
    notes += said
    family, elements = (family_in(table, options) if options.kind == "estimate" else (None, {}))
    layout = (family.name if family and family.is_layout else
              "EuRoC" if columns[6] < columns[3] else "TUM")
    why = (f"the header names {table.written[columns[0]]}, "
           f"{table.written[min(columns[3:])]} first")
    P, assumed = None, []
    if family:
        why += f", and {table.written[min(elements.values())]}"
        P, said = named_covariances(table, family, elements, poses, options)
        notes += said
        if any(one in table.names[k] for k in elements.values() for one in ("roll", "yaw")):
            assumed.append("roll, pitch and yaw in the covariance are rotations about x, y and z "
                           "(rx, ry, rz), which they are of small angles alone")
    return Run(table.path, f"{layout}, since {why}", POSE_COLUMNS, table.places, times, poses, P,
               notes, assumed)


def named_covariances(table, family, elements, poses, options):
    """Covariances under a header with position first, and notes."""
    if options.order and family.named:
        refuse_order(table.header_place, options)
    P, notes = covariances_named(table, family, elements)
    is_own = table.names[0] == "time_s" and "x_m" in table.names  # as JUDGING_ESTIMATES has it
    if options.order or not (family.orders or is_own):
        columns = "the covariance of columns named by indices"
        P, said = in_asked_order(P, options, (table.places or [table.path])[0], columns)
        notes += said
    if family.name == "OpenVINS":
        P = turned_into_map(poses, P)
        notes.append("the rotation's covariance is turned into the map: judge it by --error world")
    if family.name == "cnspy":
        P = cnspy_convention(table, poses, P, notes)
    if family.name == "ROS":
        notes.append("the message defines the covariance in the frame of the map (--error world), "
                     "but not every program keeps to it")
    return P, notes


def time_words(table):
    """Words, places and unit of the times. ROS has them in whole nanoseconds or in two columns."""
    names = table.names
    for whole, part in (("header.stamp.secs", "header.stamp.nsecs"),
                        ("header.stamp.sec", "header.stamp.nanosec")):
        if whole in names and part in names:
            pairs = [(row[names.index(whole)], row[names.index(part)]) for row in table.rows]
            if all(a.isdigit() and b.isdigit() for a, b in pairs):
                return [a + b.zfill(9) for a, b in pairs], table.places, "ns"
    column = names.index("header.stamp") if "header.stamp" in names else table.column("time")
    if column is None:
        raise ConversionError(f"{table.header_place}: no column of times (t, time, timestamp, "
                              "time_s or header.stamp): add it")
    words, unit = [row[column] for row in table.rows], table.units[column]
    if not unit and names[column] in ("time_s", "timestamp_s", "timestamp_ns"):
        unit = names[column].rpartition("_")[2]
    is_rostopic = any(name.startswith("field.") for name in table.written)
    if is_rostopic and all(map(str.isdigit, words)):
        unit = "ns"
    if unit and unit not in SECONDS_IN:
        raise ConversionError(f"{table.header_place}: times in '{unit}' (s, ms, us and ns are "
                              "read): name the unit, as in time_s")
    return words, table.places, unit


# ---- without a header: the count of numbers

def read_without_header(table, options):
    """A pose in space in the first 8 columns, known by the count of numbers."""
    width = len(table.rows[0]) if table.rows else 8
    if width not in (8, 17, 20, 29, 44):
        raise ConversionError(f"{table.places[0]}: {width} numbers without a header (8 are a pose "
                              "of TUM, 20 of OpenVINS, 29 or 44 a pose and its covariance): name "
                              "the columns in a first line, such as t,tx,ty,tz,qx,qy,qz,qw")
    times, notes = seconds([row[0] for row in table.rows], table.places or [table.path], "",
                           options.time)
    is_clock = bool(table.rows and notes)
    if is_clock and width != 17 and not options.quaternion:
        raise ConversionError(f"{table.places[0]}: no header, and times not in s (as "
                              "in EuRoC, where some programs write q_w first and others last): "
                              "say --quaternion wxyz or --quaternion xyzw")
    if width == 17 and not is_clock:
        raise ConversionError(f"{table.places[0]}: 17 numbers without a header, times in s (EuRoC "
                              "has ns): name the columns in a first line, or say --time ns")
    is_euroc = width == 17 and not options.quaternion
    columns = [1, 2, 3, 5, 6, 7, 4] if is_euroc else [1, 2, 3, 4, 5, 6, 7]
    poses, said = poses_of(table, columns, options)
    notes += said
    taken, other = ("wxyz", "xyzw") if is_euroc else ("xyzw", "wxyz")
    assumed = [] if said or not table.rows else [
        f"no header: the quaternion is in the order {taken}, as in "
        f"{'EuRoC' if is_euroc else 'TUM'}; if it is not, say --quaternion {other}"]
    layout = f"{'EuRoC' if is_clock else 'TUM'}, since {width} numbers begin with a time and a pose"
    P = None
    if options.kind == "estimate" and width in (20, 29, 44):
        values = table.numbers(range(8, width))
        if width == 20:
            layout, P = blocks_without_header(table, values, poses, options, notes)
        else:
            P, how = whole_covariances(values, options, table.places[0])
            P, said = in_asked_order(P, options, table.places[0],
                                     "a covariance without a header")
            notes += said
            layout = f"wide TUM, since {width} numbers begin with a time and a pose; {how}"
    return Run(table.path, layout, POSE_COLUMNS, table.places, times, poses, P, notes, assumed)


def blocks_without_header(table, values, poses, options, notes):
    """Covariances of 12 numbers: OpenVINS writes those of the rotation first, others do not."""
    if not options.order:
        raise ConversionError(f"{table.places[0]}: 20 numbers without the header of OpenVINS (12 "
                              "of the covariance, in an order that no check can tell): say "
                              "--order rotation-first, as OpenVINS writes it, or --order "
                              "position-first")
    blocks = {"rotation-first": (slice(3, 6), slice(0, 3)),
              "position-first": (slice(0, 3), slice(3, 6))}[options.order]
    P = np.zeros((len(values), 6, 6))
    rows, columns = np.triu_indices(3)
    for k, block in enumerate(blocks):
        part = np.zeros((len(values), 3, 3))
        part[:, rows, columns] = part[:, columns, rows] = values[:, 6 * k:6 * k + 6]
        P[:, block, block] = part
    notes.append(ZERO_BETWEEN)
    if options.order == "rotation-first":
        notes.append("the rotation's covariance is turned into the map: judge it by --error world")
        return "OpenVINS, by --order rotation-first", turned_into_map(poses, P)
    return "a pose and two blocks of a covariance, by --order position-first", P


# ---- SQUARE, the format of smfeval

def read_square(table, options):
    """The declared format SQUARE/0.3: a pose and the lower triangle of the covariance."""
    declared = table.declared
    representation = declared.get("REPRESENTATION", "")
    if representation not in ("gaussian_se3", "deterministic"):
        raise ConversionError(f"{table.path}: REPRESENTATION {representation or 'is missing'} (of "
                              "SQUARE, a mean with its covariance can be judged): write "
                              "gaussian_se3")
    width = 29 if representation == "gaussian_se3" else 8
    if table.rows and len(table.rows[0]) != width:
        raise ConversionError(f"{table.places[0]}: {len(table.rows[0])} numbers ({width} are a row "
                              f"of SQUARE {representation}): write all rows alike")
    unit = {"seconds": "s", "nanoseconds": "ns"}.get(declared.get("TIMESTAMP_UNIT", "seconds"), "")
    times, notes = seconds([row[0] for row in table.rows], table.places, unit, options.time)
    poses, said = poses_of(table, list(range(1, 8)), options)
    notes += said
    P = None
    if representation == "gaussian_se3" and options.kind == "estimate":
        order = {"translation_rotation": "position-first",
                 "rotation_translation": "rotation-first"}.get(declared.get("TANGENT_ORDER"))
        error = {"right_perturbation": "left-invariant",
                 "left_perturbation": "right-invariant"}.get(declared.get("TANGENT_CONVENTION"))
        if not order or not error:
            raise ConversionError(f"{table.path}: no TANGENT_ORDER or TANGENT_CONVENTION (SQUARE "
                                  "declares them): add the lines")
        if options.order:
            refuse_order(table.path, options)
        P = in_order(from_triangle(table.numbers(range(8, 29)), "lower"), options, order)
        notes.append(f"its covariance is {declared['TANGENT_CONVENTION']}: judge it by --error "
                     f"{error}")
        gauge = declared.get("GAUGE", "fixed")
        if gauge != "fixed":
            notes.append(f"GAUGE {gauge}: " + (
                "judge it with --anchor yaw" if gauge == "gravity_yaw"
                else "the truth must be moved onto the first estimate: see judge --anchor"))
    return Run(table.path, "SQUARE, since its first lines declare it", POSE_COLUMNS, table.places,
               times, poses, P, notes)


# ---- standard deviations, of any state

def read_sigmas(table, options):
    """A state of any kind with a column sigma_NAME for each component."""
    if options.order:
        refuse_order(table.header_place, options)
    times, notes = seconds(*time_words(table), options.time)
    columns = [table.column(name) for name in POSE]
    if None not in columns:
        states, said = poses_of(table, columns, options)
        columns, names = POSE_COLUMNS, ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
        notes += said
    else:
        taken = [k for k, name in enumerate(table.names)
                 if pose_name(name) != "time" and not is_deviation(name)]
        states, columns = table.numbers(taken), tuple(table.written[k] for k in taken)
        names = [column.lower() for column in columns]
    sigma = [next((k for k, own in enumerate(table.names)
                   if own in ("sigma_" + name, "sigma_" + name.rpartition("_")[0])), None)
             for name in names]
    if None in sigma:
        name = names[sigma.index(None)]
        raise ConversionError(f"{table.header_place}: no column sigma_{name} (every component has "
                              "a standard deviation, in the unit of its column): add it")
    unused = [own for k, own in enumerate(table.names)
              if is_deviation(own) and k not in sigma]
    if unused:
        raise ConversionError(f"{table.header_place}: {unused[0]} belongs to no column (the state "
                              f"is {','.join(columns)}): name it like its column")
    deviations = table.numbers(sigma)
    if (deviations < 0).any():
        k = int(np.argwhere(deviations < 0)[0][0])
        raise ConversionError(f"{table.places[k]}: a standard deviation below 0 (0 is a component "
                              "that is known exactly): correct it")
    P = np.zeros((*deviations.shape, deviations.shape[1]))
    np.einsum("kii->ki", P)[:] = deviations**2
    notes.append(ALL_ZERO)
    return Run(table.path, f"standard deviations, since the header names {table.written[sigma[0]]}",
               columns, table.places, times, states, P, notes)


# ---- the table of layouts, and covariances in a file beside

def is_judged_already(table, options):
    """Whether `montecarta judge` reads the file as it is and no option is to change it."""
    is_changed = (options.order or options.quaternion or options.time or options.planar
                  or options.align)
    has_covariance = any(name.startswith("cov_") for name in table.names)
    return (table.names[:1] == ("time_s",) and not is_changed
            and (has_covariance or options.kind == "truth"))


def refuse_judged(table, options):
    raise ConversionError(
        f"{table.path}: is already what judge reads (its header begins with time_s): run "
        + (f"montecarta judge {table.path} --truth TRUTH.csv ..." if options.kind == "estimate"
           else f"montecarta judge ESTIMATE.csv --truth {table.path} ..."))


def has_sigmas(table, options):
    return options.kind == "estimate" and any(map(is_deviation, table.names))


LAYOUTS = (  # recognises(table, options), read(table, options); the first that recognises it reads
    (is_judged_already, refuse_judged),
    (lambda table, options: table.declared.get("FORMAT", "").startswith("SQUARE/"), read_square),
    (has_sigmas, read_sigmas),
    (lambda table, options: bool(table.names), read_under_header),
    (lambda table, options: True, read_without_header))


def covariances_beside(run, options):
    """The run with the covariances of its file STEM.cov, if there is one."""
    path = os.path.splitext(run.path)[0] + ".cov"
    if not run.times or not os.path.isfile(path) or path == run.path:
        return run
    if run.covariances is not None:
        raise ConversionError(f"{run.path}: has covariances, and so has {path} (one is needed): "
                              "move one of the two to another folder")
    table = Table(path)
    width = len(table.rows[0]) if table.rows else 37
    if width not in (37, 22):
        raise ConversionError(f"{table.places[0]}: {width} numbers in the line (a timestamp and 36 "
                              "or 21 are a covariance): write all lines alike")
    times, _ = seconds([row[0] for row in table.rows], table.places, "", options.time)
    if len(times) != len(run.times):
        raise ConversionError(f"{path}: {len(times)} covariances of {len(run.times)} poses in "
                              f"{run.path} (every pose has one): write them at the same times")
    for k, (own, time) in enumerate(zip(times, run.times)):
        if abs(own - time) > SAME_TIME:
            raise ConversionError(f"{table.places[k]}: time {own} s is not that of "
                                  f"{run.places[k]} (every pose has one covariance): write them "
                                  "at the same times")
    P, how = whole_covariances(table.numbers(range(1, width)), options, table.places[0])
    P, said = in_asked_order(P, options, table.places[0], "a covariance without a header")
    return dataclasses.replace(run, covariances=P, notes=[
        *run.notes, f"covariances in the file .cov beside: {how}", *said])


def read(path, options):
    """The run in a text file. Its kind is options.kind: estimate, truth, or the states of estimates
    without their covariances."""
    table = Table(path)
    run = next(read_it for recognises, read_it in LAYOUTS if recognises(table, options))(
        table, options)
    if options.kind == "truth" and not run.times:
        raise ConversionError(f"{path}: no rows (a truth of no time): write one row for each time")
    if options.kind != "estimate":
        return run
    run = covariances_beside(run, options)
    if not run.times and run.covariances is None:
        return dataclasses.replace(run, covariances=np.zeros((0, 6, 6)))
    if run.covariances is None and table.names:
        refuse_unknown(table, run.layout)
    if run.covariances is None:
        raise ConversionError(f"{path}: no covariances ({run.layout}; without them nothing can be "
                              "judged): add their 36 or 21 numbers to each row, or write them to "
                              f"{os.path.splitext(path)[0]}.cov")
    return run
