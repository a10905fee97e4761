// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fastslam2_position.hpp"

template std::unique_ptr<montecarta::engine::SlamFilter>
montecarta::filters::make_fastslam2_position<montecarta::engine::Lanes>(const FilterSetup&);
