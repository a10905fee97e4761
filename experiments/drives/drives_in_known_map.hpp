// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/namespaces.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// Drives in a known map (EQUATIONS 23): every run has a Prior with all landmarks. Its means are
/// the truth minus errors that are drawn anew in every run.
class DrivesInKnownMap final : public DriveSource {
 public:
  /// `own_landmarks` is that of StudyPlan. The errors have the deviations `drawn`, and the
  /// covariances of the priors have those of `believed`.
  DrivesInKnownMap(std::shared_ptr<const DriveSource> drives,
                   std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks,
                   const PriorDeviations& drawn, const PriorDeviations& believed,
                   std::uint64_t seed);

  const Itinerary& itinerary() const override { return drives_->itinerary(); }
  std::size_t own_drives() const override { return drives_->own_drives(); }
  const Itinerary& itinerary_of(std::uint64_t run) const override {
    return drives_->itinerary_of(run);
  }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  PoseMoments start_of(std::uint64_t run) const;
  std::vector<LandmarkEstimate> map_of(std::uint64_t run) const;

  std::shared_ptr<const DriveSource> drives_;
  std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_;
  PriorDeviations drawn_, believed_;
  std::uint64_t seed_;
};

}  // namespace montecarta::experiments
