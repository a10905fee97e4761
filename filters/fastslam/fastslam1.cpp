// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/motion_sampling.hpp"

template std::unique_ptr<montecarta::engine::SlamFilter>
montecarta::filters::make_fastslam1<montecarta::engine::Lanes>(const FilterSetup&);
