// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/anchored.hpp"
#include "filters/fastslam/srcd.hpp"

namespace montecarta {

FilterKind srcd_aided_kind() {
  std::vector<FilterOption> options = srcd_options();
  options.push_back(landmarks_option());
  return {.name = "srcd_aided",
          .long_name = "SRCD-aided FastSLAM",
          .source = "Ankishan et al. 2016, Table 1; SPEC 11",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = [](const FilterSetup& setup) {
            return make_anchored_or(setup, Linearised(), make_srcd_aided<Lanes>);
          }};
}

}  // namespace montecarta
