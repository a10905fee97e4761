// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"

#include "engine/errors.hpp"
#include "filters/dead_reckoning.hpp"
#include "filters/equivariant/equivariant_filter.hpp"
#include "filters/fastslam/de_srcd.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_filters.hpp"
#include "filters/joint/joint_filter.hpp"
#include "filters/marginal/marginal_filter.hpp"
#include "filters/plain/plain_filters.hpp"
#include "filters/relative/relative_ekf_slam.hpp"
#include "filters/smoothing/smoother.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace montecarta::filters {
namespace {

std::vector<FilterKind (*)()>& added_filters() {
  static std::vector<FilterKind (*)()> added;
  return added;
}

std::vector<FilterKind> all_kinds() {
  std::vector<FilterKind> kinds{
      ekf_slam_kind(),
      riekf_slam_kind(),
      fej_ekf_slam_kind(),
      oc_ekf_slam_kind(),
      robocentric_ekf_slam_kind(),
      ukf_slam_kind(),
      right_ukf_slam_kind(),
      left_ukf_slam_kind(),
      polar_equivariant_kind(),
      fastslam1_kind(),
      fastslam2_kind(),
      ufastslam_kind(),
      srcd_kind(),
      srcd_aided_kind(),
      srcd_pf_kind(),
      de_srcd_kind(),
      marginal_kind(),
      ampf_de_kind(),
      relative_ekf_slam_kind(),
      smoother_kind(),
      fixed_lag_smoother_kind(),
      dead_reckoning_kind(),
  };
  for (FilterKind& kind : plain_kinds(kinds)) kinds.push_back(std::move(kind));
  for (const auto& make : added_filters()) {
    FilterKind kind = make();
    if (std::ranges::find(kinds, kind.name, &FilterKind::name) != kinds.end())
      throw StudyError("filter {}: there is one already: give yours another name", kind.name);
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

}  // namespace

std::span<const FilterKind> filter_kinds() {
  static const std::vector<FilterKind> kinds = all_kinds();
  return kinds;
}

std::span<const FilterKind> added_filter_kinds() {
  return filter_kinds().last(added_filters().size());
}

bool add_filter(FilterKind (*make)()) {
  added_filters().push_back(make);
  return true;
}

}  // namespace montecarta::filters
