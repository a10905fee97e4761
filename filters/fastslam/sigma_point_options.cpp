// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

std::vector<FilterOption> sigma_point_options() {
  std::vector<FilterOption> options = fast_slam_options();
  options.push_back({"weights",
                     FilterOption::Kind::choice,
                     "closed",
                     0,
                     0,
                     {"closed", "ratio"},
                     "form of the importance weight (SPEC 7.2 c, r)"});
  return options;
}

FilterOption map_uncertainty_option() {
  return {"map_uncertainty",
          FilterOption::Kind::choice,
          "on",
          0,
          0,
          {"on", "off"},
          "whether a landmark's covariance counts when the pose is refined; printed without"};
}

MapUncertainty map_uncertainty(const FilterOptions& options) {
  return options.choice("map_uncertainty") == "on" ? MapUncertainty::on : MapUncertainty::off;
}

std::vector<FilterOption> central_difference_options() {
  return {{"interval",
           FilterOption::Kind::number,
           "1.7320508075688772",
           1,
           10,
           {},
           "h of the central differences; its square is the kurtosis, 3 for a Gaussian (SPEC 9)"},
          {"weights_of_sigma_points",
           FilterOption::Kind::choice,
           "corrected",
           0,
           0,
           {"corrected", "as_printed"},
           "as_printed: the misprints of Ankishan eq. (14), about the central point"}};
}

SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty) {
  const double h = setup.options.number("interval");
  const bool corrected = setup.options.choice("weights_of_sigma_points") == "corrected";
  const SigmaRule rule =
      corrected ? central_difference_rule(h) : central_difference_rule_as_printed(h);
  return SigmaPoints({.motion = rule, .pose = rule, .landmark = rule}, setup.belief,
                     map_uncertainty);
}

}  // namespace montecarta
