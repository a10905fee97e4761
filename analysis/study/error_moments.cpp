// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/error_moments.hpp"

#include <cmath>

namespace montecarta::analysis {

ErrorTrace error_trace(std::uint64_t run, std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  ErrorTrace trace;
  trace.run = run;
  for (std::size_t s = 0; s < errors.size(); ++s) {
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      trace.error[component].push_back(errors[s](c));
      trace.deviation[component].push_back(std::sqrt(covariances[s](c, c)));
    }
  }
  return trace;
}

void ErrorMoments::add(std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (!errors[s].allFinite() || !covariances[s].allFinite()) continue;
    scans_[s].n += 1.0;
    scans_[s].error += errors[s];
    scans_[s].squares += errors[s].cwiseAbs2();
    scans_[s].variances += covariances[s].diagonal();
  }
}

ErrorsOverTime ErrorMoments::result() const {
  ErrorsOverTime found;
  for (const ScanSums& sums : scans_) {
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      found.rms[component].push_back(std::sqrt(sums.squares(c) / sums.n));
      found.believed[component].push_back(std::sqrt(sums.variances(c) / sums.n));
      found.mean[component].push_back(sums.error(c) / sums.n);
    }
  }
  return found;
}

}  // namespace montecarta::analysis
