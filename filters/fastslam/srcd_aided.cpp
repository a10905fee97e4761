// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/srcd.hpp"

namespace montecarta {

FilterKind srcd_aided_kind() {
  return {.name = "srcd_aided",
          .long_name = "SRCD-aided FastSLAM",
          .source = "Ankishan et al. 2016, Table 1; EQUATIONS 8",
          .has_particles = true,
          .has_mixture = true,
          .options = srcd_options(),
          .make = make_srcd_aided<Lanes>};
}

}  // namespace montecarta
