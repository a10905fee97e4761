// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

#include "filters/setup/filter_kind.hpp"

#include <string>
#include <utility>

namespace montecarta::filters {
namespace {

const std::vector<std::string> kWeightForms{"closed", "ratio", "batch"};

}  // namespace

WeightForm weight_form(const FilterOptions& options) {
  return chosen<WeightForm>(options.choice("weights"), kWeightForms);
}

FilterKind refined_kind(const char* name, const char* long_name, const char* source,
                        std::vector<Parameter> options,
                        std::unique_ptr<SlamFilter> make(const FilterSetup&)) {
  return {.name = name,
          .long_name = long_name,
          .source = source,
          .reports = {.particles = true, .mixture = true},
          .options = std::move(options),
          .takes_prior = true,
          .takes_fixes = true,
          .restrict_reports =
              [](const FilterSetup& setup, Capabilities& reports) {
                if (weight_form(setup.options) == WeightForm::ratio) reports.mixture = false;
              },
          .make = make};
}

FilterKind of_all_sensors(FilterKind kind) {
  kind.sensors.clear();
  kind.delays_initialisation = true;
  return kind;
}

FilterKind fastslam1_kind() {
  return {.name = "fastslam1",
          .long_name = "FastSLAM I",
          .source = "Montemerlo et al. 2002; EQUATIONS 5",
          .reports = {.particles = true},
          .options = population_options(),
          .sensors = {},
          .delays_initialisation = true,
          .takes_prior = true,
          .takes_fixes = true,
          .make = make_fastslam1_of_sensor<Lanes>};
}

FilterKind fastslam2_kind() {
  return of_all_sensors(refined_kind(
      "fastslam2", "FastSLAM II", "Montemerlo et al. 2003; EQUATIONS 6",
      population_options({{choice_parameter("weights", "closed", kWeightForms,
                                            "form of the importance weight (EQUATIONS 6)")}}),
      make_fastslam2_of_sensor<Lanes>));
}

}  // namespace montecarta::filters
