// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/association/pairing.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Which landmark of one map a detection is, by identity or the nearest (EQUATIONS 17), for filters
/// whose map is the same for all particles, or that have a map for each belief. Landmarks are
/// numbered in the order in which they are added.
class MapAssociation {
 public:
  explicit MapAssociation(const FilterSetup& setup);

  void clear();
  bool known() const { return settings_.kind == Association::known; }
  const AssociationSettings& settings() const { return settings_; }

  /// Pairs a scan by identity, or by what a search of the map found for each detection.
  void pair_by_identity(Scan scan);
  void pair_nearest(Scan scan, std::span<const NearestSearch> searches);
  std::span<const Pairing> pairings() const { return pairings_; }
  /// Against the simulator's identities.
  const AssociationCounts& counts() const { return counts_; }
  /// log p0: what a detection that matches nothing is worth (EQUATIONS 17); 0 where identities are
  /// known.
  double unmatched_log_density() const { return known() ? 0.0 : log_new_density_; }

  /// Remembers that the map's next landmark is made of this detection. Throws RunError where the
  /// map has run away.
  void add(const Detection& fresh);
  /// Where the map holds landmark k of a report: of identity k if they are known, else the k-th
  /// added. Any number beyond the map's size where it does not.
  std::size_t slot_of(std::size_t k) const;

 private:
  static constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

  Pairing pairing_by_identity(const Detection& detection) const;

  AssociationSettings settings_;
  double log_new_density_;
  std::vector<std::uint32_t> slot_of_identity_;  ///< where they are known
  std::vector<std::int32_t> made_of_;  ///< {slot} identity at initialisation, to count errors
  std::vector<Pairing> pairings_;      ///< of the last scan
  AssociationCounts counts_;
};

/// The pose and the first `landmarks` landmarks of a report; NaN of those that the map does not
/// hold. `row_of_slot(slot)` is the first row in `held` of what the map holds there, negative where
/// it holds nothing.
template <class RowOfSlot>
JointEstimate joint_report(const JointEstimate& held, const MapAssociation& association,
                           std::size_t landmarks, const RowOfSlot& row_of_slot) {
  std::vector<Eigen::Index> rows{0, 1, 2};  // in `held`
  for (std::size_t k = 0; k < landmarks; ++k) {
    const Eigen::Index row = row_of_slot(association.slot_of(k));
    rows.push_back(row);
    rows.push_back(row < 0 ? row : row + 1);
  }
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto size = static_cast<Eigen::Index>(rows.size());
  const auto row = [&](Eigen::Index i) { return rows[static_cast<std::size_t>(i)]; };
  JointEstimate report{Eigen::VectorXd::Constant(size, unknown),
                       Eigen::MatrixXd::Constant(size, size, unknown)};
  for (Eigen::Index a = 0; a < size; ++a) {
    if (row(a) < 0) continue;
    report.mean(a) = held.mean(row(a));
    for (Eigen::Index b = 0; b < size; ++b) {
      if (row(b) >= 0) report.covariance(a, b) = held.covariance(row(a), row(b));
    }
  }
  return report;
}

}  // namespace montecarta::filters
