// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/moved.hpp"

#include "engine/errors.hpp"

#include <string>

namespace montecarta {

FilterOption move_lag_option() {
  return {"move_lag",
          FilterOption::Kind::integer,
          "0",
          0,
          1000,
          {},
          "scans whose poses are proposed anew after a resampling (resample-move); 0 = none"};
}

std::size_t move_lag(const FilterOptions& options) { return options.integer("move_lag"); }

void check_move(const FilterSetup& setup) {
  const std::size_t lag = move_lag(setup.options);
  if (lag == 0) return;
  const std::string asked = "move_lag = " + std::to_string(lag);
  if (setup.association.kind != Association::known) {
    throw StudyError(asked +
                     " and association.kind = nearest (a scan of the past would be paired anew for "
                     "every particle): give association.kind = known or move_lag = 0");
  }
  if (are_anchored(setup.options)) {
    throw StudyError(asked +
                     " and landmarks = anchored (the two are not made to go together): give "
                     "landmarks = cartesian or move_lag = 0");
  }
}

}  // namespace montecarta
