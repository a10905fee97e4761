// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/cell_spec.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {

std::span<const Option> mismatch_options() {
  static const std::vector<Option> options = {
      number_option("motion_noise", "1", 1e-3, 1e3,
                    "factor on the believed deviations of the controls"),
      number_option("sensor_noise", "1", 1e-3, 1e3,
                    "factor on the believed sigma_range and sigma_bearing")};
  return options;
}

double mismatch_of(const CellSpec& cell, std::string_view name) {
  const auto found =
      std::ranges::find_if(cell.mismatch, [&](const auto& factor) { return factor.first == name; });
  return found == cell.mismatch.end() ? 1.0 : to_number(found->second).value();
}

}  // namespace montecarta::experiments
