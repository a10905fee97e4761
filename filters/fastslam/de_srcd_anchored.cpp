// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/de_srcd.hpp"

namespace montecarta {

template std::unique_ptr<SlamFilter> make_de_srcd_anchored<Lanes>(const FilterSetup&);

}  // namespace montecarta
