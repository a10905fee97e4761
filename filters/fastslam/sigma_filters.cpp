// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/sigma_filters.hpp"

template std::unique_ptr<montecarta::engine::SlamFilter>
montecarta::filters::make_srcd_aided<montecarta::engine::Lanes>(const FilterSetup&);
template std::unique_ptr<montecarta::engine::SlamFilter>
montecarta::filters::make_srcd_pf<montecarta::engine::Lanes>(const FilterSetup&);
