// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/passed_innovations.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::experiments {
namespace {

using analysis::chi_squared_cdf;
using analysis::chi_squared_quantile;
using analysis::chi_squared_tail;

/// Number of innovations beyond a limit by a law, of which none is there, that shows a gate. By
/// chance none is there once in 22,000 times.
constexpr double kExpectedBeyond = 10.0;

/// Text of a gate that lets `largest` pass and is so near to it that the NIS up to it show: the
/// next half, or the limit of a usual share; else `largest` itself, rounded up.
std::string likely_gate(double largest, double freedom, double nearness) {
  double limit = std::ceil(2.0 * largest) / 2.0;
  std::string text = to_text(limit);
  for (const double share : std::array{90.0, 95.0, 97.5, 99.0, 99.5, 99.7, 99.9}) {
    const double of_share = chi_squared_quantile(0.01 * share, freedom);
    if (of_share < largest || of_share >= limit) continue;
    limit = of_share;
    text = to_text(share) + "%";
  }
  if (limit - largest <= nearness) return text;
  const double step = std::pow(10.0, std::floor(std::log10(largest)) - 2.0);
  return engine::exact_text(std::ceil(largest / step) * step);
}

}  // namespace

void PassedInnovations::add(double nis, std::uint32_t components) {
  if (components == 0 || !std::isfinite(nis)) return;
  NisSum& rows = rows_[components];
  ++rows.count;
  rows.sum += nis;
  rows.largest = std::max(rows.largest, nis);
}

void PassedInnovations::add(const PassedInnovations& others) {
  for (const auto& [components, rows] : others.rows_) {
    NisSum& mine = rows_[components];
    mine.count += rows.count;
    mine.sum += rows.sum;
    mine.largest = std::max(mine.largest, rows.largest);
  }
}

std::string PassedInnovations::limits_of(const Gate& gate) const {
  std::string text;
  for (const auto& [components, rows] : rows_) {
    const analysis::GatedRows passed{static_cast<double>(rows.count),
                                     static_cast<double>(components), gate.limit(components)};
    if (!passed.is_usable()) {
      throw StudyError(
          "--gate {}: a limit of {} for the NIS of {} components (it must be above {} and below "
          "{}, of fewer than {} components): write e.g. 9 or 99%",
          gate.text(), to_text(passed.limit), components, to_text(passed.kLeastLimit),
          to_text(passed.kMostLimit), to_text(passed.kMostComponents));
    }
    text += formatted("{}{} rows of {} up to {}", text.empty() ? "" : ", ", rows.count, components,
                      to_text(passed.limit));
  }
  return text;
}

std::string PassedInnovations::sign_of_a_gate(const std::string& sensor) const {
  for (const auto& [components, rows] : rows_) {
    const auto n = static_cast<double>(rows.count), freedom = static_cast<double>(components);
    const double largest = rows.largest;
    const bool is_limit = largest >= 1.0 && !(largest > 89.5 && largest < 100.0);  // and no share
    if (!is_limit || n * chi_squared_tail(largest, freedom) < kExpectedBeyond) continue;
    const double scale = analysis::chi_squared_scale_up_to(largest, freedom, rows.sum / n);
    const double inside = chi_squared_cdf(largest / scale, freedom);
    if (n * chi_squared_tail(largest / scale, freedom) < kExpectedBeyond * inside) continue;
    // The distance within which the fitted law has five innovations.
    const double near = largest * (1.0 - 1e-3), share_near = chi_squared_cdf(near / scale, freedom);
    const double nearness = 5.0 * (largest - near) * inside / (n * (inside - share_near));
    const std::string gate = likely_gate(largest, freedom, nearness);
    const double limit = Gate(gate).limit(components);
    const std::string of = components == 1 ? " component" : " components";
    return formatted(
        "no NIS of {} is beyond {}, where {} of {} would be expected of {}{}: if the filter leaves "
        "them out, say --gate {}{}",
        sensor.empty() ? "the innovations" : "sensor " + sensor, engine::readable(limit, 3),
        std::llround(n * chi_squared_tail(limit, freedom)), rows.count, components, of,
        sensor.empty() ? "" : sensor + "=", gate);
  }
  return "";
}

}  // namespace montecarta::experiments
