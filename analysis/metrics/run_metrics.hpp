// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/diversity.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/moments.hpp"
#include "analysis/metrics/nees.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// NEES of one run by one definition of the moments; empty where no covariance is stored.
struct NeesRows {
  std::array<std::size_t, 3> dimension = {3, 2, 1};  ///< {block} components
  /// {block}{scan} on the scale of all components (on_full_scale()); NaN if a sample is unusable or
  /// nothing of it can be judged. A block may be empty but the first.
  std::array<std::vector<double>, 3> value;
  std::array<std::vector<int>, 3> rank;  ///< {block}{scan} of the covariance, as Nees::rank
  /// {block}{scan} too few effective draws to be judged (SamplerScale), value NaN; empty where the
  /// moments are not corrected.
  std::array<std::vector<std::uint8_t>, 3> too_few;

  void set(std::size_t block, std::size_t scan, const Nees& sample) {
    value[block][scan] = sample.value;
    rank[block][scan] = sample.rank;
  }
  void resize(std::size_t scans) {
    for (auto& values : value) values.resize(scans);
    for (auto& ranks : rank) ranks.resize(scans);
  }
};

/// What one run says, scan by scan. Keeps its memory from run to run; one per thread.
class RunMetrics {
 public:
  /// Reads `rows` of a complete run with `particles` (0: none); `times` [s] of the scans. Without
  /// truth there are no errors and no NEES: their rows are empty.
  void measure(const RunRows& rows, std::size_t particles, std::span<const double> times);

  const NeesRows& nees(Moments moments) const { return nees_[static_cast<std::size_t>(moments)]; }
  /// By the first of kMoments that is there; nullptr where none is.
  const NeesRows* leading_nees() const;
  /// [m^2] {scan}, of the mean of estimate_of().
  const std::vector<double>& squared_position() const { return squared_position_; }
  /// [rad^2] {scan}
  const std::vector<double>& squared_heading() const { return squared_heading_; }
  /// {scan} errors of the same mean, estimate - truth, in the frame of the true vehicle: forward
  /// [m], left [m], heading [rad].
  const std::vector<Eigen::Vector3d>& errors() const { return errors_; }
  /// {scan} covariance of estimate_of() in the same frame; empty where none is stored.
  const std::vector<Eigen::Matrix3d>& covariances() const { return covariances_; }
  /// nullptr where there are no ancestors, as lineages().
  const Diversity* diversity() const { return diversity_; }
  const Lineages* lineages() const { return lineages_ ? &*lineages_ : nullptr; }

 private:
  void measure_errors(const RunRows& rows, std::size_t scans);
  void turn_into_vehicle(const RunRows& rows);

  void correct_spread(const RunRows& rows, std::size_t particles);

  std::array<NeesRows, kMoments.size()> nees_;  ///< {Moments}
  std::vector<double> squared_position_, squared_heading_;
  std::vector<Eigen::Vector3d> errors_;
  std::vector<Eigen::Matrix3d> covariances_;
  DiversityCounter counter_;
  const Diversity* diversity_ = nullptr;
  LineageWalker walker_;
  std::optional<Lineages> lineages_;
};

}  // namespace montecarta::analysis
