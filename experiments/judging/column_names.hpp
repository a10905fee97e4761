// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_shape.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// Names of columns or of components.
using Names = std::vector<std::string>;

inline const std::string kCovariancePrefix = "cov_", kSigmaPrefix = "sigma_";
inline const Names kPoseColumns = {"x_m", "y_m", "heading_rad"};
/// Other names of the heading, each followed by _rad.
inline const Names kOtherHeadings = {"yaw", "theta", "psi", "phi"};
inline const std::string kNis = "nis", kNisDof = "nis_dof", kSensor = "sensor";

bool has_name(const Names& names, const std::string& name);

/// Index of a name; the number of names if it is not there.
std::size_t place_of_name(const Names& names, const std::string& name);

/// A name without its unit, if it has one that is read.
std::string without_unit(const std::string& name);

/// Whether a column is the standard deviation of another one, or of a component of a rotation.
bool is_deviation(const std::string& name, const Names& header);

/// The names of the state in a header, without those of a truth beside it.
Names state_in_header(const Names& header);

/// The heading in the names of columns: heading_rad, or another name of it. Empty if there is none,
/// or if there are several other names.
std::string heading_in(const Names& columns);

/// The names of a state, where another name of the heading of a pose is replaced by its usual one.
Names usual_names(Names state);

/// Index in a header of a column of a state of this kind; the size of the header if it has none.
std::size_t place_of_column(const Names& header, const std::string& column, StateKind kind);

/// Component and unit in a column name such as "vx_mps". Throws StudyError that begins with `place`
/// if the unit is not read, or is missing where it is needed.
std::pair<std::string, std::string> component_and_unit(const std::string& column,
                                                       const std::string& place);

}  // namespace montecarta::experiments
