// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/pairing.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Associates the detections of a scan with the landmarks of one map, by identity or by nearest
/// neighbour (EQUATIONS 17). It serves filters with one map for all particles, or one for each
/// belief. The slot of a landmark is its number in the order in which landmarks are added.
class MapAssociation {
 public:
  explicit MapAssociation(const FilterSetup& setup);

  void clear();
  bool known() const { return settings_.kind == Association::known; }
  const AssociationSettings& settings() const { return settings_; }

  /// Both functions pair the detections of a scan, by identity or by a search of the map for each
  /// detection.
  void pair_by_identity(Scan scan);
  void pair_nearest(Scan scan, std::span<const NearestSearch> searches);
  std::span<const Pairing> pairings() const { return pairings_; }
  /// Association errors of the last scan, counted with the simulator's identities.
  const AssociationCounts& counts() const { return counts_; }
  /// log p0, the log-density of a detection that matches no landmark (EQUATIONS 17); 0 where
  /// identities are known.
  double unmatched_log_density() const { return known() ? 0.0 : log_new_density_; }

  /// Records that the next landmark of the map is known, or initialised from a detection, with this
  /// identity. Throws RunError if the map has grown beyond its limit.
  void add(std::int32_t identity);
  /// Slot of landmark k of a report: the landmark of identity k if identities are known, else the
  /// k-th that was added. A slot beyond the end of the map means that the map does not hold it.
  std::size_t slot_of(std::size_t k) const;

 private:
  static constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

  Pairing pairing_by_identity(const Detection& detection) const;

  AssociationSettings settings_;
  double log_new_density_;
  /// {identity} slot of the landmark, if identities are known.
  std::vector<std::uint32_t> slot_of_identity_;
  std::vector<std::int32_t> made_of_;  ///< {slot} identity at initialisation, to count errors
  std::vector<Pairing> pairings_;      ///< result of the last scan
  AssociationCounts counts_;
};

/// The pose and the first `landmarks` landmarks of a report, NaN for landmarks that the map does
/// not hold. `row_of_slot(slot)` is the first row in `held` of the landmark in that slot, negative
/// if there is none.
template <class RowOfSlot>
JointEstimate joint_report(const JointEstimate& held, const MapAssociation& association,
                           std::size_t landmarks, const RowOfSlot& row_of_slot) {
  std::vector<Eigen::Index> rows{0, 1, 2};  // rows in `held` of the reported components
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
