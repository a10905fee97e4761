// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/gate.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <cmath>

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

}  // namespace montecarta::experiments
