// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_options.hpp"

#include "filters/setup/filter_options.hpp"
#include "filters/setup/resampling_options.hpp"

#include <string>

namespace montecarta {
namespace {

const std::vector<std::string> kWeightForms{"closed", "ratio", "batch"};

}  // namespace

std::vector<Option> fast_slam_options() { return resampling_options("100"); }

FastSlamSettings fast_slam_settings(const FilterOptions& options) {
  return {.particles = options.integer("particles"),
          .resampling = chosen_resampling(options),
          .resample_below = options.number("resample_below")};
}

const std::vector<std::string>& weight_form_names() { return kWeightForms; }

WeightForm weight_form(const FilterOptions& options) {
  return chosen<WeightForm>(options.choice("weights"), kWeightForms);
}

}  // namespace montecarta
