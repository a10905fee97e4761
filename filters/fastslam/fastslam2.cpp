// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/moved.hpp"

namespace montecarta {

FilterKind fastslam2_kind() {
  std::vector<FilterOption> options = fast_slam_options();
  options.push_back({"weights", FilterOption::Kind::choice, "closed", 0, 0, weight_form_names(),
                     "form of the importance weight (SPEC 7.2 c, r, b)"});
  options.push_back(landmarks_option());
  options.push_back(move_lag_option());
  return {.name = "fastslam2",
          .long_name = "FastSLAM II",
          .source = "Montemerlo et al. 2003; SPEC 7",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make =
              [](const FilterSetup& setup) {
                return make_as_chosen(setup, Linearised(), make_fastslam2<Lanes>);
              },
          .check = check_move};
}

}  // namespace montecarta
