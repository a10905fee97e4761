// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>

namespace montecarta::engine {

/// What a study may ask to be stored (study file: record.columns). The per-scan diagnostics
/// (ess, resampled, log_likelihood, nis, nis_dof, numerical_faults, map_size) and pose_mean are
/// always stored.
struct ColumnSelection {
  bool covariance =
      true;  ///< pose_covariance; pose_mean_mixture, pose_covariance_mixture where there is one
  bool ancestry = true;      ///< ancestor
  bool particles = false;    ///< particle_pose, log_weight
  bool association = false;  ///< association_correct, _wrong, _new_again, _missed, _clutter
  bool map = false;          ///< map_mean, map_covariance, map_seen, at every scan
  bool final_map = false;    ///< final_map_mean, final_map_covariance, final_map_seen, at the last
  bool joint = false;        ///< joint_mean, joint_covariance of filters that have a joint estimate
  std::size_t joint_scans = 16;  ///< record.joint_scans: at so many scans (joint_scans_of())
  bool scans_only = false;       ///< record.rate = scan: rows of `time` only where a scan was taken
};

}  // namespace montecarta::engine
