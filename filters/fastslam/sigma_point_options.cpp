// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

std::vector<Option> sigma_point_options() {
  std::vector<Option> options = population_options();
  options.push_back(choice_option("weights", "closed", {"closed", "ratio"},
                                  "form of the importance weight (SPEC 7.2 c, r)"));
  return options;
}

Option map_uncertainty_option() {
  return choice_option(
      "map_uncertainty", "on", {"on", "off"},
      "whether a landmark's covariance counts when the pose is refined; printed without");
}

MapUncertainty map_uncertainty(const FilterOptions& options) {
  return options.choice("map_uncertainty") == "on" ? MapUncertainty::on : MapUncertainty::off;
}

std::vector<Option> central_difference_options() {
  return {
      number_option(
          "interval", "1.7320508075688772", 1, 10,
          "h of the central differences; its square is the kurtosis, 3 for a Gaussian (SPEC 9)"),
      choice_option("weights_of_sigma_points", "corrected", {"corrected", "as_printed"},
                    "as_printed: the misprints of Ankishan eq. (14), about the central point")};
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
