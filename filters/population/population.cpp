// SPDX-License-Identifier: BSD-3-Clause
#include "filters/population/population.hpp"

namespace montecarta::filters {
namespace {

// In the order of the enumerators.
const std::vector<std::string> kResamplings{"systematic", "stratified", "residual", "multinomial"};

}  // namespace

std::vector<Option> population_options() {
  return {
      count_option("particles", "100", 1, 1e6, "number of particles"),
      choice_option("resampling", "systematic", kResamplings, "draw of the parents (EQUATIONS 18)"),
      number_option("resample_below", "0.5", 0, 1,
                    "resample where ESS < this times particles; Bailey's simulator has 0.75")};
}

PopulationSettings population_settings(const FilterOptions& options) {
  return {.particles = options.integer("particles"),
          .resampling = chosen<Resampling>(options.choice("resampling"), kResamplings),
          .resample_below = options.number("resample_below")};
}

}  // namespace montecarta::filters
