# SPDX-License-Identifier: BSD-3-Clause
"""Covariances {row, 6, 6} of poses in space: the names that their elements have in headers, their
triangles, and the order of position and rotation.
"""
import dataclasses
import os
import re

from conversion import ConversionError, np
from estimate_table import pose_name

COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
ROTATION_FIRST = [3, 4, 5, 0, 1, 2]  # where x, y, z, rx, ry, rz are in such a covariance
SEMIDEFINITE_SLACK = 1e-5  # of eigenvalues of correlations, if printed with six digits

ZERO_BETWEEN = ("no covariance between position and rotation in the file: it is taken as 0, so "
                "that the NEES varies more")
ALL_ZERO = ("no covariances between components in the file: they count as 0, so that the NEES "
            "varies more")


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


def triangle_of(values, options, path, declared=""):
    """The triangle of 21 numbers per row, "upper" or "lower", and whether only it gives
    covariances, as nothing else says which it is."""
    triangle = declared or options.triangle
    if triangle:
        return triangle, False
    fits = [one for one in ("upper", "lower")
            if np.all(is_semidefinite(from_triangle(values, one)))]
    if len(fits) != 1:
        raise ConversionError(f"{path}: 21 numbers of a covariance ({len(fits)} of 2 triangles "
                              "give a covariance in every row): say --triangle upper or "
                              "--triangle lower")
    return fits[0], True


def whole_covariances(values, options, path, declared=""):
    """Covariances {row, 6, 6} of 36 or 21 numbers per row, and how the 21 were taken."""
    if values.shape[1] == 36:
        return values.reshape(-1, 6, 6), "36 numbers are the covariance row by row"
    triangle, is_guessed = triangle_of(values, options, path, declared)
    why = ", since the other gives no covariance" if is_guessed else ""
    return from_triangle(values, triangle), f"21 numbers are the {triangle} triangle{why}"


# ---- the order of position and rotation

def in_order(P, options, declared=""):
    """The covariances with position first. `declared` is the order that the file names."""
    if (declared or options.order) == "rotation-first" and P is not None:
        return P[:, ROTATION_FIRST][:, :, ROTATION_FIRST]
    return P


def in_asked_order(P, options, place, what):
    """The covariances with position first, and a note on the order, which nothing in the file says.
    Without --order they are refused; `what` has them."""
    if not options.order and len(P):
        deviations = ", ".join(f"{one:.3g}" for one in np.sqrt(np.maximum(np.diag(P[0]), 0)))
        raise ConversionError(f"{place}: {what} (nothing says whether position or rotation comes "
                              f"first; the deviations of this row are {deviations}): say --order "
                              "position-first if the first three are those of the position in m, "
                              "or --order rotation-first if they are those of the rotation in rad")
    return in_order(P, options), [f"{options.order} by --order"] if options.order else []


def refuse_order(place, options):
    raise ConversionError(f"{place}: --order {options.order} (the file names the order of its "
                          "covariance): leave it out")


# ---- the element (row, column) that a name stands for

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


COMPONENT = r"(?:(?:p|t|pos_?)?[xyz]|(?:r|rot_?|th|theta_?|phi_?)[xyz]|roll|pitch|yaw)"


def component_of(word):
    """Index of a component in COMPONENTS by one of its names."""
    if word in ("roll", "pitch", "yaw"):
        return 3 + ("roll", "pitch", "yaw").index(word)
    return "xyz".index(word[-1]) + 3 * bool(re.match("r|th|phi", word))


def element_by_components(name):
    found = re.fullmatch(rf"(?:pose[._]?)?(?:cov(?:ar|ariance)?[._(]?|[pc][._(])"
                         rf"({COMPONENT})[._]?({COMPONENT})\)?", name)
    return found and (component_of(found[1]), component_of(found[2]))


INDEXED = (r"(?:pose[._]?)?(p|c|cov|covar|covariance|sigma|var)[._]?[(\[{]*"
           r"(?:(\d)(\d)|(\d+)[\W_x]+(\d+)|(\d+))[)\]}]*")


def is_deviation(name):
    """Whether a column has the standard deviation of a component."""
    return name.startswith("sigma_") and not re.fullmatch(INDEXED, name)


def elements_by_name(element):
    """A function [((row, column), column of the table)] of the table's names."""
    return lambda table, options: [(element(name), k) for k, name in enumerate(table.names)
                                   if element(name)]


def elements_by_index(table, options):
    """The elements of names with indices, P_00 or cov_1_1, or with one number from 0 or 1 on."""
    found = {k: re.fullmatch(INDEXED, name) for k, name in enumerate(table.names)}
    found = {k: match for k, match in found.items() if match and not ros_element(table.names[k])}
    letters = sorted({match[1] for match in found.values()})
    if len(letters) > 1:
        raise ConversionError(f"{table.header_place}: covariances named {letters[0]} and "
                              f"{letters[1]} (one is needed): leave out the columns of the other")
    by_number = {int("".join(filter(None, match.groups()[1:]))): k for k, match in found.items()
                 if not match[4]}
    for count in (36, 21):
        for first in (0, 1):
            if sorted(by_number) == list(range(first, first + count)) and letters != ["sigma"]:
                return numbered_elements(table, [by_number[n] for n in sorted(by_number)], options)
    pairs = {k: (int(match[2] or match[4]), int(match[3] or match[5]))
             for k, match in found.items() if not match[6]}
    indices = {index for pair in pairs.values() for index in pair}
    base = 0 if 0 in indices else 1
    wrong = [k for k, pair in pairs.items() if max(pair) > 5 + base]
    if wrong:
        raise ConversionError(f"{table.header_place}: '{table.written[wrong[0]]}' (a pose has six "
                              "components, with the indices 0 to 5 or 1 to 6): leave out the "
                              "columns of others, and name those of the pose "
                              + ", ".join(SUGGESTED))
    return [((i - base, j - base), k) for k, (i, j) in pairs.items()]


def numbered_elements(table, columns, options):
    """The elements of columns in the order of their numbers."""
    if len(columns) == 36:
        return [(divmod(n, 6), k) for n, k in enumerate(columns)]
    triangle = "upper"
    if table.rows:
        triangle, _ = triangle_of(table.numbers(columns), options, table.header_place)
    places = np.triu_indices(6) if triangle == "upper" else np.tril_indices(6)
    return [((int(i), int(j)), k) for i, j, k in zip(*places, columns)]


@dataclasses.dataclass
class Family:
    """Names that a covariance has in headers. `is_layout`: they belong to the layout `name`.
    `has_blocks`: position and rotation may come without covariance between them. `orders`: it is
    certain which elements are of the position. `named`: the names say it."""
    name: str
    elements: callable
    is_layout: bool
    has_blocks: bool
    orders: bool
    named: bool


FAMILIES = (
    Family("OpenVINS", elements_by_name(open_vins_element), True, True, True, True),
    Family("cnspy", elements_by_name(cnspy_element), True, True, True, True),
    Family("ROS", elements_by_name(ros_element), True, False, True, False),
    Family("components", elements_by_name(element_by_components), False, True, True, True),
    Family("indices", elements_by_index, False, True, False, False))
SUGGESTED = ("cov_x_x", "cov_x_y", "...", "cov_rz_rz (of x, y, z, rx, ry, rz)")


def family_in(table, options):
    """The family that names elements of a covariance, with {element: column}; None without one."""
    found = []
    for family in FAMILIES:
        elements = {}
        for element, k in family.elements(table, options):
            if element in elements:
                raise ConversionError(f"{table.header_place}: '{table.written[k]}' and "
                                      f"'{table.written[elements[element]]}' are the same element "
                                      "of the covariance (one is needed): leave out the other")
            elements[element] = k
        if elements:
            found.append((family, elements))
    if len(found) > 1:
        names = [f"'{table.written[min(elements.values())]}'" for _, elements in found]
        raise ConversionError(f"{table.header_place}: covariances named {names[0]}, ... and "
                              f"{names[1]}, ... (one is needed): leave out the columns of the "
                              "other")
    return found[0] if found else (None, {})


def not_understood(table, elements=()):
    """A list in words of columns that are neither of the pose nor of its covariance; may be
    empty."""
    names = [name for k, name in enumerate(table.written)
             if k not in elements and not pose_name(table.names[k])]
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def refuse_unknown(table, layout):
    """Refuses a header without a covariance that the scripts know."""
    unknown = not_understood(table)
    what = f"no column of {unknown} is known as one; " if unknown else ""
    raise ConversionError(f"{table.header_place}: no covariances ({what}{layout}; without them "
                          "nothing can be judged): name their columns "
                          f"{', '.join(SUGGESTED)}, or cov_0_0, cov_0_1, ... with --order; or "
                          f"write them to {os.path.splitext(table.path)[0]}.cov")


def covariances_named(table, family, elements):
    """Covariances {row, 6, 6} of the elements in the header, and notes on what they lack."""
    given = {(min(pair), max(pair)) for pair in elements}
    whole = [(i, j) for i in range(6) for j in range(i, 6)]
    blocks = [(i, j) for i, j in whole if i // 3 == j // 3]
    needed, notes = whole, []
    if family.has_blocks and given <= set(blocks):
        needed, notes = blocks, [ZERO_BETWEEN]
    if not family.is_layout and given <= {(i, i) for i in range(6)}:
        needed, notes = [(i, i) for i in range(6)], [ALL_ZERO]
    for i, j in needed:
        if (i, j) in given:
            continue
        what = (f"{COMPONENTS[i]} and {COMPONENTS[j]}" if family.orders else
                f"components {i + 1} and {j + 1}")
        unknown = not_understood(table, elements.values())
        raise ConversionError(f"{table.header_place}: no column of the covariance of {what} (the "
                              f"header has {len(elements)} like "
                              f"{table.written[min(elements.values())]}"
                              + (f", and does not say what {unknown} are" if unknown else "")
                              + "): add it, named like the others")
    values = table.numbers(list(elements.values()))
    P = np.zeros((len(values), 6, 6))
    for k, (i, j) in enumerate(elements):
        P[:, i, j] = values[:, k]
        if (j, i) not in elements:
            P[:, j, i] = values[:, k]
    return P, notes
