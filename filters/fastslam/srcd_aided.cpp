// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

template std::unique_ptr<montecarta::SlamFilter> montecarta::make_srcd_aided<montecarta::Lanes>(
    const FilterSetup&);
