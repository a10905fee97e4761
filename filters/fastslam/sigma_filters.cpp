// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/sigma_filters.hpp"

#include "filters/setup/filter_kind.hpp"

#include <string>
#include <utility>

namespace montecarta::filters {

template std::unique_ptr<SlamFilter> make_srcd_aided<Lanes>(const FilterSetup&);
template std::unique_ptr<SlamFilter> make_srcd_pf<Lanes>(const FilterSetup&);

namespace {

Parameter weights_of_sigma_points_option() {
  return choice_parameter("weights", "closed", {"closed", "ratio"},
                          "form of the importance weight (EQUATIONS 6)");
}

const std::vector<std::string> kNewLandmarks{"corrected", "as_printed"};

Parameter new_landmarks_option() {
  return choice_parameter("new_landmarks", "corrected", kNewLandmarks,
                          "covariance of a new landmark; Ankishan eq. (24), (25) add the sensor's "
                          "noise once more, in its own units (EQUATIONS 8)");
}

NewLandmarks new_landmarks(const FilterOptions& options) {
  return chosen<NewLandmarks>(options.choice("new_landmarks"), kNewLandmarks);
}

}  // namespace

Parameter map_uncertainty_option() {
  return choice_parameter("map_uncertainty", "on", {"on", "off"},
                          "whether the covariance of a landmark is used when the pose is refined; "
                          "the papers print it without");
}

MapUncertainty map_uncertainty(const FilterOptions& options) {
  return options.choice("map_uncertainty") == "on" ? MapUncertainty::on : MapUncertainty::off;
}

std::vector<Parameter> central_difference_options() {
  return {number_parameter("interval", "1.7320508075688772", 1, 10,
                           "step h of the central differences; its square is the kurtosis, 3 for a "
                           "Gaussian (EQUATIONS 3)"),
          choice_parameter(
              "weights_of_sigma_points", "corrected", {"corrected", "as_printed"},
              "whether the misprints of Ankishan eq. (14) about the central point are corrected")};
}

SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty,
                                      NewLandmarks new_landmarks) {
  const double h = setup.options.number("interval");
  const bool corrected = setup.options.choice("weights_of_sigma_points") == "corrected";
  const SigmaRule rule =
      corrected ? central_difference_rule(h) : central_difference_rule_as_printed(h);
  return SigmaPoints({.motion = rule, .pose = rule, .landmark = rule}, setup.belief,
                     map_uncertainty, new_landmarks);
}

SigmaPoints unscented_points(const FilterSetup& setup) {
  const auto rule = [&](double n) {
    return unscented_rule(n, setup.options.number("alpha"), setup.options.number("beta"),
                          setup.options.number("kappa"));
  };
  const double controls = static_cast<double>(controls_of(setup.belief.vehicle).size());
  return SigmaPoints({.motion = rule(3 + controls), .pose = rule(5), .landmark = rule(2)},
                     setup.belief, map_uncertainty(setup.options));
}

FilterKind ufastslam_kind() {
  return of_all_sensors(refined_kind(
      "ufastslam", "U-FastSLAM", "Kim et al. 2008; EQUATIONS 7",
      population_options(
          {{weights_of_sigma_points_option(),
            number_parameter(
                "alpha", "0.9", 1e-3, 1,
                "spread of the sigma points; Kim's paper has 0.002, Kim's code 0.9 (EQUATIONS 7)"),
            number_parameter(
                "beta", "2", 0, 10,
                "weight of the centre in covariances; 2 suits a Gaussian (EQUATIONS 7)"),
            number_parameter("kappa", "0", 0, 10,
                             "second parameter of the spread: alpha^2 (n + kappa) is the squared "
                             "distance of the points"),
            map_uncertainty_option()}}),
      [](const FilterSetup& setup) {
        return make_refined_of_sensor<Lanes>(setup, unscented_points(setup));
      }));
}

FilterKind srcd_kind() {
  return of_all_sensors(
      refined_kind("srcd", "SRCD-FastSLAM", "Ankishan et al. 2016; EQUATIONS 8",
                   population_options({{weights_of_sigma_points_option()},
                                       central_difference_options(),
                                       {map_uncertainty_option(), new_landmarks_option()}}),
                   [](const FilterSetup& setup) {
                     return make_refined_of_sensor<Lanes>(
                         setup, central_difference_points(setup, map_uncertainty(setup.options),
                                                          new_landmarks(setup.options)));
                   }));
}

FilterKind srcd_aided_kind() {
  return refined_kind(
      "srcd_aided", "SRCD-aided FastSLAM", "Ankishan et al. 2016, Table 1; EQUATIONS 8",
      population_options({{weights_of_sigma_points_option()}, central_difference_options()}),
      make_srcd_aided<Lanes>);
}

FilterKind srcd_pf_kind() {
  return refined_kind("srcd_pf", "SRCD-PF FastSLAM", "Ankishan et al. 2016, Table 1; EQUATIONS 8",
                      population_options({{weights_of_sigma_points_option()},
                                          central_difference_options(),
                                          {map_uncertainty_option()}}),
                      make_srcd_pf<Lanes>);
}

}  // namespace montecarta::filters
