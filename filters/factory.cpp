// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"

#include "filters/dead_reckoning.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/joint/joint_filters.hpp"
#include "filters/marginal/marginal_filter.hpp"

namespace montecarta::filters {

std::span<const FilterKind> filter_kinds() {
  static const std::vector<FilterKind> kinds{
      ekf_slam_kind(),  riekf_slam_kind(),     hrb_kind(),     fastslam1_kind(),
      fastslam2_kind(), ufastslam_kind(),      srcd_kind(),    srcd_aided_kind(),
      srcd_pf_kind(),   de_srcd_kind(),        delayed_kind(), marginal_kind(),
      ampf_de_kind(),   dead_reckoning_kind(),
  };
  return kinds;
}

}  // namespace montecarta::filters
