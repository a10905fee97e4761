// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed.hpp"

namespace montecarta {

template std::unique_ptr<SlamFilter> make_delaying<Lanes>(const FilterSetup&, const SigmaPoints&,
                                                          const Anchored&);

}  // namespace montecarta
