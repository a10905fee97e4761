// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/layout_mistakes.hpp"

#include "analysis/run/nees.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace montecarta::analysis {
namespace {

constexpr std::array<const char*, kLayoutMistakes> kNamesOfMistakes = {
    "rotation before position", "angles in degrees",
    "angles in rad where those of estimates and truths are in degrees", "lengths in mm",
    "standard deviations in place of variances"};

/// Returns whether components are all positions [m], then angles [rad].
bool are_positions_then_angles(std::span<const std::string> units) {
  const auto first_angle = std::ranges::find(units, "rad");
  return first_angle != units.begin() && first_angle != units.end() &&
         std::all_of(units.begin(), first_angle, [](const auto& unit) { return unit == "m"; }) &&
         std::all_of(first_angle, units.end(), [](const auto& unit) { return unit == "rad"; });
}

LayoutCorrection as_stated(std::span<const std::string> units) {
  LayoutCorrection stated{.from = std::vector<Eigen::Index>(units.size()),
                          .scale = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(units.size()))};
  std::iota(stated.from.begin(), stated.from.end(), Eigen::Index{0});
  return stated;
}

/// Deviations in `unit` are `factor` times the stated numbers.
LayoutCorrection scaled(std::span<const std::string> units, const char* unit, double factor) {
  if (std::ranges::find(units, unit) == units.end()) return {};
  LayoutCorrection found = as_stated(units);
  for (std::size_t i = 0; i < units.size(); ++i)
    if (units[i] == unit) found.scale(static_cast<Eigen::Index>(i)) = factor;
  return found;
}

/// Positions have the places behind the rotation.
LayoutCorrection rotation_first(std::span<const std::string> units) {
  if (!are_positions_then_angles(units)) return {};
  LayoutCorrection found = as_stated(units);
  std::rotate(found.from.begin(), found.from.begin() + std::ranges::count(units, "rad"),
              found.from.end());
  return found;
}

}  // namespace

std::string name_of(LayoutMistake mistake) {
  return kNamesOfMistakes.at(static_cast<std::size_t>(mistake));
}

double LayoutCorrection::variance(const double* stated, std::size_t i) const {
  const auto k = static_cast<std::size_t>(from[i]);
  const double of_place = stated[k * from.size() + k], s = scale(static_cast<Eigen::Index>(i));
  return s * s * (is_squared ? of_place * of_place : of_place);
}

LayoutCorrection correction_of(LayoutMistake mistake, std::span<const std::string> units) {
  constexpr double kDegree = std::numbers::pi / 180.0, kMillimetre = 1e-3;
  switch (mistake) {
    case LayoutMistake::rotation_first:
      return rotation_first(units);
    case LayoutMistake::degrees:
      return scaled(units, "rad", kDegree);
    case LayoutMistake::radians:
      return scaled(units, "rad", 1.0 / kDegree);
    case LayoutMistake::millimetres:
      return scaled(units, "m", kMillimetre);
    case LayoutMistake::deviations:
      break;
  }
  LayoutCorrection deviations = as_stated(units);
  deviations.is_squared = true;
  return deviations;
}

double PartRatios::distance() const {
  return std::fmax(std::abs(std::log(lengths)), std::abs(std::log(angles)));  // ignores NaN
}

bool PartRatios::has_same_parts(const PartRatios& other) const {
  return std::isnan(lengths) == std::isnan(other.lengths) &&
         std::isnan(angles) == std::isnan(other.angles);
}

void LayoutMistakes::add(const ErrorRows& errors, std::span<const std::string> units) {
  const std::size_t d = units.size();
  if (d != errors.components()) return;
  std::vector<LayoutCorrection> corrections = {as_stated(units)};
  for (std::size_t k = 0; k < kLayoutMistakes; ++k)
    corrections.push_back(correction_of(static_cast<LayoutMistake>(k), units));
  for (std::size_t s = 0; s < errors.scans(); ++s) {
    const double* const covariance = errors.covariance.data() + s * d * d;
    for (std::size_t i = 0; i < d; ++i) {
      const bool is_length = units[i] == "m";
      if (!is_length && units[i] != "rad") continue;
      const double error = errors.value[s * d + i];
      for (std::size_t k = 0; k < corrections.size(); ++k) {
        if (corrections[k].from.empty()) continue;
        const double variance = corrections[k].variance(covariance, i);
        const double square = error * error / variance;
        if (!(variance > 0.0) || !std::isfinite(square)) continue;
        Part& part = sums_[k][is_length ? 0 : 1];
        part.squares += std::min(square, kLargestNees);
        part.n += 1.0;
      }
    }
  }
}

PartRatios LayoutMistakes::ratios(std::size_t k) const {
  const auto mean = [](const Part& part) { return part.squares / part.n; };
  return {mean(sums_[k][0]), mean(sums_[k][1])};
}

std::optional<LayoutMistake> LayoutMistakes::far_nearer() const {
  const auto is_farther = [](double ratio, double stated) {
    constexpr double kNear = 3.0;
    const double distance = std::abs(std::log(ratio));
    return distance > std::log(kNear) && distance > std::abs(std::log(stated));
  };
  const double far = std::log(kFarNearer);
  double least = std::min(stated().distance() - far, far);
  std::optional<LayoutMistake> nearest;
  for (std::size_t k = 0; k < kLayoutMistakes; ++k) {
    const auto mistake = static_cast<LayoutMistake>(k);
    const double distance = without(mistake).distance();
    if (!std::isfinite(distance) || !(distance <= least)) continue;  // also if there are no parts
    if (!without(mistake).has_same_parts(stated())) continue;
    if (is_farther(without(mistake).lengths, stated().lengths)) continue;
    if (is_farther(without(mistake).angles, stated().angles)) continue;
    least = distance;
    nearest = mistake;
  }
  return nearest;
}

std::string in_words(const LayoutMistakes& mistakes) {
  const auto mistake = mistakes.far_nearer();
  if (!mistake) return "";
  const PartRatios stated = mistakes.stated(), without = mistakes.without(*mistake);
  const bool has_lengths = !std::isnan(stated.lengths), has_angles = !std::isnan(stated.angles);
  std::string ratios;
  if (has_lengths && has_angles) {
    ratios = engine::formatted(
        "lengths are {} times their variances and those of angles {} times, instead of {} and {}",
        compact(without.lengths), compact(without.angles), compact(stated.lengths),
        compact(stated.angles));
  } else {
    ratios = engine::formatted("{} are {} times their variances, instead of {}",
                               has_lengths ? "lengths" : "angles",
                               compact(has_lengths ? without.lengths : without.angles),
                               compact(has_lengths ? stated.lengths : stated.angles));
  }
  return engine::formatted(
      "If the covariances are written with {}, squared errors of {} times, which is far nearer to "
      "1, whatever the verdict would be",
      name_of(*mistake), ratios);
}

}  // namespace montecarta::analysis
