// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/columns.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::analysis {

/// {landmark} The map of a run after its last scan. With known association the rows are identities
/// of the world, else the order of initialisation.
struct FinalMap {
  std::vector<std::uint32_t> seen;          ///< {landmark} 1 if it is in the map
  std::vector<Eigen::Vector2d> mean;        ///< [m] {landmark} estimated position
  std::vector<Eigen::Matrix2d> covariance;  ///< [m^2] {landmark} covariance of the position

  /// [m] positions of the landmarks that are in the map.
  std::vector<Eigen::Vector2d> places() const {
    std::vector<Eigen::Vector2d> found;
    for (std::size_t l = 0; l < seen.size(); ++l) {
      if (seen[l] != 0) found.push_back(mean[l]);
    }
    return found;
  }
};

/// Mean and covariance of the pose at every scan of one run; empty if not stored.
struct MomentRows {
  std::vector<double> mean;        ///< {scan, 3} [m, m, rad] mean of the pose
  std::vector<double> covariance;  ///< {scan, 3, 3} covariance of the pose
};

/// Mean and covariance of the pose at every stored row of one run, also between scans.
struct PathRows {
  MomentRows spread;   ///< covariance empty if no reference has known errors
  MomentRows mixture;  ///< empty if not stored

  /// {row, 3} [m, m, rad] The leading mean; empty without references.
  const std::vector<double>& mean() const {
    return mixture.mean.empty() ? spread.mean : mixture.mean;
  }
};

/// Counts of the associations of every scan (AssociationCounts); empty where not stored.
struct AssociationRows {
  /// {scan} number of associations of each kind.
  std::vector<double> correct, wrong, new_again, missed, clutter;
};

/// Progress of differential evolution at every scan (EQUATIONS (9.3)); 0 where nothing evolved, and
/// empty where it is not stored.
struct EvolutionRows {
  /// {scan} evaluations of the fitness; means over the populations of the others.
  std::vector<double> evaluations, generations, gain, displacement;
};

/// Estimate of pose and map together at the scans of ResultDescription::joint_scans; empty if not
/// stored.
struct JointRows {
  std::vector<double> mean;        ///< {joint scan, state} mean; NaN for landmarks never seen
  std::vector<double> covariance;  ///< {joint scan, state, state} covariance

  std::size_t states() const { return mean.empty() ? 0 : covariance.size() / mean.size(); }
};

/// [m, rad] Errors up to these are explained by rounding, of numbers and of poses that another
/// program rounds to single precision.
inline constexpr double kDoubleRounding = 1e-9, kSingleRounding = 1e-6;

/// Errors of an imported estimate at every scan, in the convention that its file states; empty
/// where not stored.
struct ErrorRows {
  std::vector<double> value;       ///< {scan, component} error of the estimate
  std::vector<double> covariance;  ///< {scan, component, component} covariance as imported
  /// {kErrorConventions}{scan} NEES if the covariance belonged to the error of that convention;
  /// empty if not stored.
  std::array<std::vector<double>, kErrorConventions.size()> nees_by;

  /// Errors up to this of components that are known exactly are rounding: in single precision, of
  /// poses.
  double rounding() const { return nees_by.front().empty() ? kDoubleRounding : kSingleRounding; }
  std::size_t components() const { return value.empty() ? 0 : covariance.size() / value.size(); }
  std::size_t scans() const { return value.empty() ? 0 : value.size() / components(); }
  Eigen::VectorXd error(std::size_t scan) const {
    const auto d = static_cast<Eigen::Index>(components());
    return Eigen::Map<const Eigen::VectorXd>(value.data() + scan * components(), d);
  }
  Eigen::MatrixXd covariance_of(std::size_t scan) const {
    const auto d = static_cast<Eigen::Index>(components());
    const double* rows = covariance.data() + scan * components() * components();
    return Eigen::Map<const Eigen::MatrixXd>(rows, d, d).transpose();
  }
};

/// All data of one run that the analysis uses, as plain arrays. Columns that are not stored are
/// empty.
struct RunRows {
  std::vector<double> truth;  ///< {scan, 3} [m, m, rad]; empty if unknown
  /// {scan before the first one that is judged, 3} [m, m, rad] truth, which says what came into
  /// view; empty if all scans are judged.
  std::vector<double> earlier_truth;
  MomentRows spread;  ///< mean always stored, except in files of states that are no poses
  MomentRows mixture;
  std::vector<double> ess;               ///< {scan} column `ess`
  std::vector<std::uint32_t> resampled;  ///< {scan} 1 if the filter resampled at the scan, else 0
  /// {scan} number of factorisations that needed a fallback.
  std::vector<std::uint32_t> numerical_faults;
  /// {scan, particle} index of the parent among the particles one scan ago.
  std::vector<std::uint32_t> ancestor;
  std::vector<double> particle_pose;   ///< {scan, particle, 3} [m, m, rad] pose of each particle
  std::vector<double> log_weight;      ///< {scan, particle} logarithm of the normalised weight
  std::vector<double> nis;             ///< {scan} normalised innovation squared (NIS)
  std::vector<std::uint32_t> nis_dof;  ///< {scan} number of degrees of freedom of the NIS
  AssociationRows association;
  PathRows path;                 ///< estimates at all rows; empty without references
  std::vector<double> map_size;  ///< {scan} number of landmarks in the map
  /// {scan} [1/rad^2] information about the heading of path and map; empty if not stored.
  std::vector<double> rotation_information;
  EvolutionRows evolution;
  std::optional<FinalMap> final_map;  ///< map at the last scan, if stored and whole
  JointRows joint;
  ErrorRows error;        ///< errors of imported estimates
  std::uint64_t run = 0;  ///< number of the run in the study
  /// [m] true positions in this run, by identity; empty if unknown.
  std::vector<Eigen::Vector2d> landmarks;
  double cpu_seconds = 0.0;
};

/// The estimate whose errors are judged: the mixture if it is stored, else the spread.
inline const MomentRows& estimate_of(const RunRows& rows) {
  return rows.mixture.mean.empty() ? rows.spread : rows.mixture;
}

}  // namespace montecarta::analysis
