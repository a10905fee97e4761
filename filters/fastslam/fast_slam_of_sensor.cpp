// SPDX-License-Identifier: BSD-3-Clause
// The filters that take any sensor, instantiated for each.
#include "filters/fastslam/delayed_association.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/motion_sampling.hpp"
#include "filters/fastslam/sigma_filters.hpp"

namespace montecarta::filters {

template std::unique_ptr<SlamFilter> make_fastslam1_of_sensor<Lanes>(const FilterSetup&);
template std::unique_ptr<SlamFilter> make_fastslam2_of_sensor<Lanes>(const FilterSetup&);
template std::unique_ptr<SlamFilter> make_refined_of_sensor<Lanes>(const FilterSetup&,
                                                                   const SigmaPoints&);

}  // namespace montecarta::filters
