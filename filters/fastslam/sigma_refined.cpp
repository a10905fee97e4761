// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta {

template std::unique_ptr<SlamFilter> make_refined<Lanes>(const FilterSetup&, const SigmaPoints&,
                                                         const SigmaPoints&);

}  // namespace montecarta
