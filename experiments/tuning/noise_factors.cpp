// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_factors.hpp"

#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

constexpr int kDigitsOfFactor = 4;

void multiply_option(const Parameter& option, double factor, CellSpec& cell) {
  const double product = mismatch_of(cell, option.key) * factor;
  std::erase_if(cell.options, [&](const auto& one) { return one.first == option.key; });
  const std::string text =
      checked_value(option, readable(product, kDigitsOfFactor),
                    formatted("{}: cell {}: {}", cell.place, cell.label, option.key));
  if (text != "1") cell.options.emplace_back(option.key, text);
}

}  // namespace

CellSpec with_noise(CellSpec cell, const NoiseFactors& factors, const std::string& label) {
  for (const Parameter& option : mismatch_options())
    multiply_option(option, option.key == "motion_noise" ? factors.motion : factors.sensor, cell);
  if (label == cell.label) return cell;
  cell.label = label;
  append_part(cell.distinction, "other noise");
  return cell;
}

Study study_of_cells(const Study& study, std::vector<CellSpec> cells, std::uint64_t runs,
                     std::uint64_t seed) {
  Study other = study;
  other.cells = std::move(cells);
  other.until.reset();
  const auto set = [&](const char* section, const char* key, const std::string& value) {
    other.settings.replace(section, key, value);
  };
  set("study", "until", "");
  set("study", "runs", std::to_string(runs));
  set("study", "seed", std::to_string(seed));
  set("record", "columns", "pose, covariance");
  set("record", "rate", "scan");
  set("record", "full_runs", "0");
  return other;
}

}  // namespace montecarta::experiments
