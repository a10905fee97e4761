// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/srcd.hpp"

namespace montecarta {

FilterKind srcd_pf_kind() {
  std::vector<Option> options = srcd_options();
  options.push_back(map_uncertainty_option());
  return {.name = "srcd_pf",
          .long_name = "SRCD-PF FastSLAM",
          .source = "Ankishan et al. 2016, Table 1; EQUATIONS 8",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = make_srcd_pf<Lanes>};
}

}  // namespace montecarta
