// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/de_srcd.hpp"

#include "filters/setup/filter_kind.hpp"

#include <string>

namespace montecarta::filters {
namespace {

/// The order is that of the enumerators.
const std::vector<std::string> kEvolutionModes{"unbiased", "as_printed", "prior", "shared"};
const std::vector<std::string> kEvolutionStarts{"cloud", "uniform"};

std::vector<Parameter> options_of_evolution() {
  return {
      choice_parameter("mode", "unbiased", kEvolutionModes,
                       "what is evolved, and whether weights account for it (EQUATIONS 10)"),
      number_parameter("scale", "0.4", 0, 2, "factor F of the difference vectors (EQUATIONS 9)"),
      number_parameter("crossover", "0.8", 0, 1, "crossover rate Cr (EQUATIONS 9)"),
      count_parameter("generations", "10", 0, 1000,
                      "largest number of generations; the paper does not give it"),
      count_parameter("population", "10", 7, 1000,
                      "size of the population that each particle has in mode unbiased; in other "
                      "modes the particles are the population"),
      choice_parameter("base", "best", kEvolutionBases, "base of a trial (EQUATIONS 9)"),
      choice_parameter("start", "cloud", kEvolutionStarts,
                       "first population where the particles are one: their poses, or poses drawn "
                       "uniformly within the bounds, Ankishan eq. (28) (EQUATIONS 10)"),
      number_parameter("bounds", "3", 0, 100, "bounds of the search in standard deviations"),
      number_parameter("inflation", "1", 1, 10,
                       "factor on the covariance of the proposal, in modes unbiased and shared")};
}

}  // namespace

EvolvedSettings evolved_settings(const FilterOptions& options) {
  return {.mode = chosen<EvolutionMode>(options.choice("mode"), kEvolutionModes),
          .evolution = {.scale = options.number("scale"),
                        .crossover = options.number("crossover"),
                        .generations = options.integer("generations"),
                        .base = chosen<EvolutionBase>(options.choice("base"), kEvolutionBases)},
          .start = chosen<EvolutionStart>(options.choice("start"), kEvolutionStarts),
          .population = options.integer("population"),
          .bounds = options.number("bounds"),
          .inflation = options.number("inflation")};
}

FilterKind de_srcd_kind() {
  return {
      .name = "de_srcd",
      .long_name = "DE-SRCD-FastSLAM",
      .source = "Ankishan et al. 2016; EQUATIONS 10",
      .reports = {.particles = true, .mixture = true, .own_columns = EvolutionReport::columns()},
      .options = population_options(
          {options_of_evolution(), central_difference_options(), {map_uncertainty_option()}}),
      .takes_prior = true,
      .takes_fixes = true,
      .restrict_reports =
          [](const FilterSetup& setup, Capabilities& reports) {
            const EvolutionMode mode = evolved_settings(setup.options).mode;
            if (weight_time(mode) == WeightTime::after_draw) reports.mixture = false;
          },
      .make = make_de_srcd<Lanes>};
}

}  // namespace montecarta::filters
