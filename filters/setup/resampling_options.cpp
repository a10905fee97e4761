// SPDX-License-Identifier: BSD-3-Clause
#include "filters/setup/resampling_options.hpp"

#include "filters/setup/filter_options.hpp"

namespace montecarta {
namespace {

using Kind = FilterOption::Kind;

// In the order of the enumerators.
const std::vector<std::string> kResamplings{"systematic", "stratified", "residual", "multinomial"};

}  // namespace

std::vector<FilterOption> resampling_options(const std::string& particles) {
  return {{"particles", Kind::integer, particles, 1, 1e6, {}, "number of particles"},
          {"resampling", Kind::choice, "systematic", 0, 0, kResamplings,
           "how parents are drawn (SPEC 18)"},
          {"resample_below",
           Kind::number,
           "0.5",
           0,
           1,
           {},
           "resample where ESS < this times particles; Bailey's simulator has 0.75"}};
}

Resampling chosen_resampling(const FilterOptions& options) {
  return chosen<Resampling>(options.choice("resampling"), kResamplings);
}

}  // namespace montecarta
