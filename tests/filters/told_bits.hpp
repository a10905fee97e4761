// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/records/columns.hpp"

#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// Gathers numbers bit by bit, so that NaN equals NaN and nothing is near enough.
class ToldBits {
 public:
  /// All that `filter` tells after a scan; it has as many particles, or 0.
  ToldBits(const SlamFilter& filter, std::size_t particles, std::size_t landmarks) {
    tell(filter.estimate());
    tell(filter.report());
    write_particle_columns(filter, particles);
    std::vector<std::optional<LandmarkEstimate>> map(landmarks);
    filter.map(map);
    for (const auto& landmark : map) {
      tell(static_cast<double>(landmark.has_value()));
      if (!landmark) continue;
      tell_all(landmark->mean.reshaped()), tell_all(landmark->covariance.reshaped());
    }
  }
  friend bool operator==(const ToldBits&, const ToldBits&) = default;

 private:
  void tell(double number) { bits_.push_back(std::bit_cast<std::uint64_t>(number)); }
  void tell_all(const auto& numbers) {
    for (const double number : numbers) tell(number);
  }
  void tell(const PoseMoments& m) {
    tell(m.mean.x), tell(m.mean.y), tell(m.mean.heading);
    tell_all(m.covariance.reshaped());
  }
  void tell(const PoseEstimate& estimate) {
    tell(estimate.spread);
    if (estimate.mixture) tell(*estimate.mixture);
  }
  void tell(const ScanReport& report) {
    for (const engine::ColumnKind& column : engine::column_table()) {
      if (column.of_report != nullptr) tell(column.of_report(report));
    }
  }
  void write_particle_columns(const SlamFilter& filter, std::size_t particles) {
    std::vector<double> poses(3 * particles), log_weights(particles);
    std::vector<std::uint32_t> ancestors(particles);
    filter.particles({poses, log_weights, ancestors});
    tell_all(poses), tell_all(log_weights);
    for (const std::uint32_t ancestor : ancestors) bits_.push_back(ancestor);
  }

  std::vector<std::uint64_t> bits_;
};

}  // namespace montecarta::filters
