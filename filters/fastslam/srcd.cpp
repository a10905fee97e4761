// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/srcd.hpp"

namespace montecarta {

FilterKind srcd_kind() {
  std::vector<Option> options = srcd_options();
  options.push_back(map_uncertainty_option());
  return {.name = "srcd",
          .long_name = "SRCD-FastSLAM",
          .source = "Ankishan et al. 2016; EQUATIONS 8",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = make_srcd<Lanes>};
}

}  // namespace montecarta
