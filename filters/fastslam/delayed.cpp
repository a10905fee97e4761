// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed.hpp"

#include "engine/numbers/angle.hpp"

namespace montecarta::filters {

std::vector<Option> delayed_options() {
  std::vector<Option> options = population_options();
  options.push_back(
      count_option("draw_every", "10", 0, 1e9,
                   "scans from one draw of the poses to the next; 1 = FastSLAM II, 0 = never"));
  options.push_back(
      number_option("draw_beyond_deg", "0", 0, 360,
                    "also draw where headings are predicted worse than this [deg]; 0 = never"));
  return options;
}

DrawTimes draw_times(const FilterOptions& options) {
  DrawTimes times{.every = options.integer("draw_every")};
  const double degrees = options.number("draw_beyond_deg");
  if (degrees > 0.0) times.beyond = degrees * kPi / 180.0;
  return times;
}

FilterKind delayed_kind() {
  return {.name = "delayed",
          .long_name = "FastSLAM II with delayed draws",
          .source = "EQUATIONS 11",
          .has_mixture = true,
          .options = delayed_options(),
          .make = make_delayed<Lanes>};
}

}  // namespace montecarta::filters
