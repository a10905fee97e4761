// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/anchored.hpp"

namespace montecarta {

template std::unique_ptr<SlamFilter> make_anchored<Lanes>(const FilterSetup&, const Linearised&);

}  // namespace montecarta
