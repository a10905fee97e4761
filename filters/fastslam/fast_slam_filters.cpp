// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

#include "filters/fastslam/sigma_filters.hpp"
#include "filters/setup/filter_kind.hpp"

#include <string>
#include <utility>

namespace montecarta::filters {
namespace {

const std::vector<std::string> kWeightForms{"closed", "ratio", "batch"};

Parameter weights_of_sigma_points_option() {
  return choice_parameter("weights", "closed", {"closed", "ratio"},
                          "form of the importance weight (EQUATIONS 6)");
}

/// FastSLAM II and the filters like it, for range and bearing at the pose.
FilterKind refined_kind(const char* name, const char* long_name, const char* source,
                        std::vector<Parameter> options,
                        std::unique_ptr<SlamFilter> make(const FilterSetup&)) {
  return {.name = name,
          .long_name = long_name,
          .source = source,
          .reports = {.particles = true, .mixture = true},
          .options = std::move(options),
          .restrict_reports =
              [](const FilterSetup& setup, Capabilities& reports) {
                if (weight_form(setup.options) == WeightForm::ratio) reports.mixture = false;
              },
          .make = make};
}

/// `kind` for all sensors, mounted anywhere.
FilterKind of_all_sensors(FilterKind kind) {
  kind.sensors.clear();
  kind.delays_initialisation = true;
  return kind;
}

}  // namespace

WeightForm weight_form(const FilterOptions& options) {
  return chosen<WeightForm>(options.choice("weights"), kWeightForms);
}

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

SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty) {
  const double h = setup.options.number("interval");
  const bool corrected = setup.options.choice("weights_of_sigma_points") == "corrected";
  const SigmaRule rule =
      corrected ? central_difference_rule(h) : central_difference_rule_as_printed(h);
  return SigmaPoints({.motion = rule, .pose = rule, .landmark = rule}, setup.belief,
                     map_uncertainty);
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

FilterKind fastslam1_kind() {
  return {.name = "fastslam1",
          .long_name = "FastSLAM I",
          .source = "Montemerlo et al. 2002; EQUATIONS 5",
          .reports = {.particles = true},
          .options = population_options(),
          .sensors = {},
          .delays_initialisation = true,
          .make = make_fastslam1_of_sensor};
}

FilterKind fastslam2_kind() {
  return of_all_sensors(refined_kind(
      "fastslam2", "FastSLAM II", "Montemerlo et al. 2003; EQUATIONS 6",
      population_options({{choice_parameter("weights", "closed", kWeightForms,
                                            "form of the importance weight (EQUATIONS 6)")}}),
      make_fastslam2_of_sensor));
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
        return make_refined_of_sensor(setup, unscented_points(setup));
      }));
}

FilterKind srcd_kind() {
  return of_all_sensors(
      refined_kind("srcd", "SRCD-FastSLAM", "Ankishan et al. 2016; EQUATIONS 8",
                   population_options({{weights_of_sigma_points_option()},
                                       central_difference_options(),
                                       {map_uncertainty_option()}}),
                   [](const FilterSetup& setup) {
                     return make_refined_of_sensor(
                         setup, central_difference_points(setup, map_uncertainty(setup.options)));
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
                      srcd_kind().options, make_srcd_pf<Lanes>);
}

}  // namespace montecarta::filters
