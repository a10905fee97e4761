// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/association/map_association.hpp"

#include <limits>
#include <vector>

namespace montecarta::filters {

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
