// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed_association.hpp"
#include "filters/fastslam/sigma_filters.hpp"

std::unique_ptr<montecarta::engine::SlamFilter> montecarta::filters::make_refined_of_sensor(
    const FilterSetup& setup, const SigmaPoints& points) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_refined<Lanes, std::decay_t<decltype(sensor_policy)>>(setup, points, points);
  });
}
