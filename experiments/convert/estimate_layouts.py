# SPDX-License-Identifier: BSD-3-Clause
"""Readers of text files in which other programs write poses in space and their covariances. The
columns are known by the header or, without one, by the count of numbers and by checks that can
fail. What stays ambiguous is refused, with the option that decides it.
"""
import dataclasses
import os
import re

import conversion
from conversion import ConversionError, np
from estimate_table import CNSPY_ERRORS, POSE, SAME_TIME, SECONDS_IN, Table, pose_name, seconds

POSE_COLUMNS = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
ROTATION_FIRST = [3, 4, 5, 0, 1, 2]  # where x, y, z, rx, ry, rz are in such a covariance
QUATERNION_SLACK = 2e-3    # tolerance of its length, if printed with three digits
SEMIDEFINITE_SLACK = 1e-5  # of eigenvalues of correlations, if printed with six digits


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


def is_semidefinite(P):
    """Which of the covariances {row, d, d} are positive semidefinite, up to their digits."""
    variances = np.einsum("kii->ki", P)
    scale = np.sqrt(np.where(variances > 0, variances, 1.0))
    correlations = P / scale[:, :, None] / scale[:, None, :]
    unknown = (variances == 0)[:, :, None] & (np.abs(P) > 0)
    return (np.linalg.eigvalsh(correlations)[:, 0] > -SEMIDEFINITE_SLACK) & ~unknown.any((1, 2))


def from_triangle(values, triangle):
    """The symmetric matrices {row, 6, 6} of 21 numbers row by row, of the upper or lower one."""
    P = np.zeros((len(values), 6, 6))
    rows, columns = np.triu_indices(6) if triangle == "upper" else np.tril_indices(6)
    P[:, rows, columns] = values
    P[:, columns, rows] = values
    return P


def whole_covariances(values, options, path, declared=""):
    """Covariances {row, 6, 6} of 36 or 21 numbers per row, and how the 21 were taken."""
    if values.shape[1] == 36:
        return values.reshape(-1, 6, 6), "36 numbers are the covariance row by row"
    triangle = declared or options.triangle
    if not triangle:
        fits = [one for one in ("upper", "lower")
                if np.all(is_semidefinite(from_triangle(values, one)))]
        if len(fits) != 1:
            raise ConversionError(f"{path}: 21 numbers of a covariance ({len(fits)} of 2 triangles "
                                  "give a covariance in every row): say --triangle upper or "
                                  "--triangle lower")
        triangle = fits[0]
        return (from_triangle(values, triangle),
                f"21 numbers are the {triangle} triangle, since the other gives no covariance")
    return from_triangle(values, triangle), f"21 numbers are the {triangle} triangle"


def in_order(P, options, declared=""):
    """The covariances with position first. `declared` is the order that the file names."""
    if (declared or options.order) == "rotation-first" and P is not None:
        return P[:, ROTATION_FIRST][:, :, ROTATION_FIRST]
    return P


def refuse_order(place, options):
    raise ConversionError(f"{place}: --order {options.order} (the file names the order of its "
                          "covariance): leave it out")


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


# ---- covariances under a header: the element (row, column) that each name stands for

def open_vins_element(name):
    found = re.fullmatch(r"p([rt])([1-3])([1-3])", name)
    first = 3 if found and found[1] == "r" else 0
    return found and (first + int(found[2]) - 1, first + int(found[3]) - 1)


def cnspy_element(name):
    found = re.fullmatch(r"p([xyz])([xyz])", name)
    if found:
        return "xyz".index(found[1]), "xyz".index(found[2])
    found = re.fullmatch(r"q([rpy])([rpy])", name)
    if found:
        return 3 + "rpy".index(found[1]), 3 + "rpy".index(found[2])
    found = re.fullmatch(r"t([xyzabc])([xyzabc])", name)
    return found and ("xyzabc".index(found[1]), "xyzabc".index(found[2]))


def ros_element(name):
    found = re.fullmatch(r"(?:.*[./])?pose\.covariance[.\[_]?(\d+)\]?", name)
    return found and int(found[1]) < 36 and divmod(int(found[1]), 6)


def montecarta_element(name):
    found = re.fullmatch(r"cov_([a-z]+|[0-5])_([a-z]+|[0-5])", name)
    keys = [*COMPONENTS, *map(str, range(6))]
    return found and found[1] in keys and found[2] in keys and tuple(
        keys.index(found[k]) % 6 for k in (1, 2))


@dataclasses.dataclass
class Family:
    """Names that a covariance has in headers. `has_blocks`: position and rotation may come without
    covariance between them. `orders`: the names say which elements are of the position."""
    name: str
    element: callable
    has_blocks: bool
    orders: bool


FAMILIES = (Family("OpenVINS", open_vins_element, True, True),
            Family("cnspy", cnspy_element, True, True),
            Family("ROS", ros_element, False, False),
            Family("montecarta", montecarta_element, False, False))


def family_in(table):
    """The family that names elements of a covariance, with {element: column}; None without one."""
    found = []
    for family in FAMILIES:
        elements = {}
        for k, name in enumerate(table.names):
            element = family.element(name)
            if element and element in elements:
                raise ConversionError(f"{table.header_place}: '{table.written[k]}' and "
                                      f"'{table.written[elements[element]]}' are the same element "
                                      "of the covariance (one is needed): leave out the other")
            if element:
                elements[element] = k
        if elements:
            found.append((family, elements))
    if len(found) > 1:
        raise ConversionError(f"{table.header_place}: covariances as in {found[0][0].name} and in "
                              f"{found[1][0].name} (one is needed): leave out the columns of the "
                              "other")
    return found[0] if found else (None, {})


def covariances_named(table, family, elements):
    """Covariances {row, 6, 6} of the elements in the header, and whether it has only blocks."""
    blocks = [(i, j) for i in range(6) for j in range(i, 6) if i // 3 == j // 3]
    whole = [(i, j) for i in range(6) for j in range(i, 6)]
    is_blocks = family.has_blocks and all(i // 3 == j // 3 for i, j in elements)
    for i, j in blocks if is_blocks else whole:
        if (i, j) not in elements and (j, i) not in elements:
            raise ConversionError(f"{table.header_place}: no column of the covariance of "
                                  f"{COMPONENTS[i]} and {COMPONENTS[j]} (the header has "
                                  f"{len(elements)} as {family.name} names them): add it")
    values = table.numbers(list(elements.values()))
    P = np.zeros((len(values), 6, 6))
    for k, (i, j) in enumerate(elements):
        P[:, i, j] = values[:, k]
        if (j, i) not in elements:
            P[:, j, i] = values[:, k]
    return P, is_blocks


ZERO_BETWEEN = ("no covariance between position and rotation in the file: it is taken as 0, so "
                "that the NEES varies more")


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
    family, elements = family_in(table)
    first_of_quaternion = table.written[min(columns[3:])]
    layout = family.name if family else "EuRoC" if columns[6] < columns[3] else "TUM"
    why = f"the header names {table.written[columns[0]]}, {first_of_quaternion} first"
    P = None
    if family and options.kind == "estimate":
        why += f", and {table.written[min(elements.values())]}"
        P, is_blocks = covariances_named(table, family, elements)
        if options.order and family.orders:
            refuse_order(table.header_place, options)
        if options.order:
            P = in_order(P, options)
            notes.append(order_note(options))
        if family.name == "OpenVINS":
            P = turned_into_map(poses, P)
            notes.append("the rotation's covariance is turned into the map: judge it by --error "
                         "world")
        if family.name == "cnspy":
            P = cnspy_convention(table, poses, P, notes)
        if family.name == "ROS":
            notes.append("the message defines the covariance in the frame of the map (--error "
                         "world), but not every program keeps to it")
        if is_blocks:
            notes.append(ZERO_BETWEEN)
    return Run(table.path, f"{layout}, since {why}", POSE_COLUMNS, table.places, times, poses, P,
               notes)


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
    if is_clock and width == 8 and not options.quaternion:
        raise ConversionError(f"{table.places[0]}: 8 numbers without a header, times not in s (as "
                              "in EuRoC, where some programs write q_w first and others last): "
                              "say --quaternion wxyz or --quaternion xyzw")
    if width == 17 and not is_clock:
        raise ConversionError(f"{table.places[0]}: 17 numbers without a header, times in s (EuRoC "
                              "has ns): name the columns in a first line, or say --time ns")
    is_euroc = width == 17 and not options.quaternion
    columns = [1, 2, 3, 5, 6, 7, 4] if is_euroc else [1, 2, 3, 4, 5, 6, 7]
    poses, said = poses_of(table, columns, options)
    notes += said or [f"no header: the quaternion is taken as {'wxyz' if is_euroc else 'xyzw'}, "
                      "which no check can tell (--quaternion)"] * bool(table.rows)
    layout = f"{'EuRoC' if is_clock else 'TUM'}, since {width} numbers begin with a time and a pose"
    P = None
    if options.kind == "estimate" and width in (20, 29, 44):
        values = table.numbers(range(8, width))
        if width == 20:
            layout, P = blocks_without_header(table, values, poses, options, notes)
        else:
            P, how = whole_covariances(values, options, table.places[0])
            P = in_order(P, options)
            layout = f"wide TUM, since {width} numbers begin with a time and a pose; {how}"
            notes.append(order_note(options))
    return Run(table.path, layout, POSE_COLUMNS, table.places, times, poses, P, notes)


def order_note(options):
    return (f"{options.order} by --order" if options.order else
            "the covariance is taken with position first (--order)")


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
    times, notes = seconds(*time_words(table), options.time)
    columns = [table.column(name) for name in POSE]
    if None not in columns:
        states, said = poses_of(table, columns, options)
        columns, names = POSE_COLUMNS, ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
        notes += said
    else:
        taken = [k for k, name in enumerate(table.names)
                 if pose_name(name) != "time" and not name.startswith("sigma_")]
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
              if own.startswith("sigma_") and k not in sigma]
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
    notes.append("no covariances between components in the file: they count as 0, so that the NEES "
                 "varies more")
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
    return options.kind == "estimate" and any(name.startswith("sigma_") for name in table.names)


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
    return dataclasses.replace(run, covariances=in_order(P, options), notes=[
        *run.notes, f"covariances in {os.path.basename(path)}: {how}", order_note(options)])


def read(path, options):
    """The run in a text file. Its kind, estimate or truth, is options.kind."""
    table = Table(path)
    run = next(read_it for recognises, read_it in LAYOUTS if recognises(table, options))(
        table, options)
    if options.kind == "truth":
        if not run.times:
            raise ConversionError(f"{path}: no rows (a truth of no time): write one row for each "
                                  "time")
        return run
    run = covariances_beside(run, options)
    if not run.times and run.covariances is None:
        return dataclasses.replace(run, covariances=np.zeros((0, 6, 6)))
    if run.covariances is None:
        raise ConversionError(f"{path}: no covariances ({run.layout}; without them nothing can be "
                              "judged): add their columns, or write them to "
                              f"{os.path.splitext(path)[0]}.cov")
    return run
