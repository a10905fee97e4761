// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/gate.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace montecarta::experiments {

Gate::Gate(const std::string& text) : text_(text) {
  const bool is_share = text.ends_with('%');
  const auto number = to_number(is_share ? text.substr(0, text.size() - 1) : text);
  const bool is_good = number && *number > 0.0 && (is_share ? *number < 100.0 : *number < 1e6);
  if (!is_good) {
    throw StudyError(
        "--gate {}: neither a limit of the NIS nor a share that passes: write e.g. 9 or 99%",
        excerpt(text));
  }
  constexpr double kLeast = 1.0, kLikeShare = 90.0, kWhole = 100.0;
  if (!is_share && (*number < kLeast || (*number >= kLikeShare && *number < kWhole))) {
    throw StudyError(
        "--gate {}: a limit of the NIS, or a share of innovations that passes? Write {}% for the "
        "share",
        text, to_text(*number < kLeast ? 100.0 * *number : *number));
  }
  (is_share ? share_ : limit_) = is_share ? *number / 100.0 : *number;
}

double Gate::limit(std::uint32_t components) const {
  if (share_ == 0.0) return limit_;
  return analysis::chi_squared_quantile(share_, static_cast<double>(components));
}

double Gate::without_gate(double nis, std::uint32_t components) const {
  if (components == 0 || std::isnan(nis)) return nis;
  return analysis::chi_squared_before_gate(nis, components, limit(components));
}

Gates::Gates(std::string text) : text_(std::move(text)) {
  if (text_.find('=') == std::string::npos) {
    of_all_.emplace(text_);
    return;
  }
  for (const std::string& part : split(text_, ',')) {
    const std::size_t end = part.rfind('=');
    const std::string sensor = end == std::string::npos ? "" : part.substr(0, end);
    if (sensor.empty() || of(sensor)) {
      throw StudyError(
          "--gate {}: '{}' (a gate is of all innovations, or each sensor has its own): write e.g. "
          "lidar=9,gps=99%",
          excerpt(text_), excerpt(part));
    }
    of_sensors_.emplace_back(sensor, Gate(part.substr(end + 1)));
  }
}

std::optional<Gate> Gates::of(const std::string& sensor) const {
  const auto found = std::ranges::find(of_sensors_, sensor, &std::pair<std::string, Gate>::first);
  return found == of_sensors_.end() ? of_all_ : found->second;
}

void Gates::require_sensors(const std::vector<std::string>& known) const {
  for (const auto& [sensor, gate] : of_sensors_) {
    if (std::ranges::count(known, sensor) > 0) continue;
    if (known.empty()) {
      throw StudyError("--gate {}: no sensor (the files have no column sensor): say --gate {}",
                       excerpt(text_), gate.text());
    }
    throw StudyError("--gate {}: no sensor '{}' (the files have {}): {}", excerpt(text_),
                     excerpt(sensor), joined(known), nearest_spelling(sensor, known));
  }
}

}  // namespace montecarta::experiments
