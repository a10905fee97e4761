// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_options.hpp"

#include "filters/setup/filter_options.hpp"

#include <string>

namespace montecarta {
namespace {

const std::vector<std::string> kWeightForms{"closed", "ratio", "batch"};

}  // namespace

const std::vector<std::string>& weight_form_names() { return kWeightForms; }

WeightForm weight_form(const FilterOptions& options) {
  return chosen<WeightForm>(options.choice("weights"), kWeightForms);
}

}  // namespace montecarta
