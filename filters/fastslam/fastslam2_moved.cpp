// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/moved.hpp"

namespace montecarta {

template std::unique_ptr<SlamFilter> make_moved<Lanes>(const FilterSetup&, const Linearised&);

}  // namespace montecarta
