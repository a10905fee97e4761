// SPDX-License-Identifier: BSD-3-Clause
// The filters that take any sensor, instantiated for each.
#include "filters/fastslam/delayed_association.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/motion_sampling.hpp"
#include "filters/fastslam/sigma_filters.hpp"

namespace montecarta::filters {

std::unique_ptr<SlamFilter> make_fastslam1_of_sensor(const FilterSetup& setup) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_fastslam1<Lanes, std::decay_t<decltype(sensor_policy)>>(setup);
  });
}

std::unique_ptr<SlamFilter> make_fastslam2_of_sensor(const FilterSetup& setup) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_fastslam2<Lanes, std::decay_t<decltype(sensor_policy)>>(setup);
  });
}

std::unique_ptr<SlamFilter> make_refined_of_sensor(const FilterSetup& setup,
                                                   const SigmaPoints& points) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_refined<Lanes, std::decay_t<decltype(sensor_policy)>>(setup, points, points);
  });
}

}  // namespace montecarta::filters
