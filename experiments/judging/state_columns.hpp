// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// What an estimator estimates.
enum class StateKind {
  pose,           ///< in the plane: x_m, y_m, heading_rad
  pose_in_space,  ///< x_m, y_m, z_m and the quaternion qx, qy, qz, qw; its error has six components
  vector          ///< anything else, in R^n
};
/// "pose", "pose in space" or "vector", as a result file has it.
std::string name_of(StateKind kind);

/// The state in the header of a file of estimates.
struct StateShape {
  StateKind kind = StateKind::vector;
  std::vector<std::string> columns;     ///< {width} of the state, in the order of StateRows
  std::vector<std::string> components;  ///< {d} of the error, without units: "x", "rx"
  std::vector<std::string> units;       ///< {d} "m", "rad", ...; "1" where the header names none

  std::size_t width() const { return columns.size(); }
  std::size_t dimension() const { return components.size(); }
  bool operator==(const StateShape&) const = default;
};

/// Where a file has what: fields of a row.
struct EstimateFields {
  StateShape shape;
  std::vector<std::size_t> state;           ///< {width}
  std::vector<std::size_t> covariance;      ///< {d, d}; of a triangle each element stands twice
  std::optional<std::size_t> nis, nis_dof;  ///< both or none
};

/// Understands the header of estimates: `time_s`, the state, then `cov_A_B` with names of
/// components or indices from 0, the whole covariance or one triangle; perhaps `nis` and `nis_dof`.
/// Throws StudyError beginning
/// with `place`.
EstimateFields estimate_fields(const std::vector<std::string>& header, const std::string& place);

/// Where a file of innovations has what.
struct InnovationFields {
  std::optional<EstimateFields> whole;  ///< innovation and covariance; else the next two
  std::size_t nis = 0, nis_dof = 0;
};

/// Understands the header of innovations: `time_s`, then `nis` and `nis_dof` alone, or as the
/// header of estimates, whose components are those of the innovation. Throws StudyError beginning
/// with `place`.
InnovationFields innovation_fields(const std::vector<std::string>& header,
                                   const std::string& place);

/// The fields of the state in the header of a truth, which may have other columns besides. Throws
/// StudyError beginning with `place`.
std::vector<std::size_t> truth_fields(const std::vector<std::string>& header,
                                      const StateShape& shape, const std::string& place);

}  // namespace montecarta::experiments
