// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/whitened_run.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "engine/core/judgement.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Returns whether a whole table of rates is asked for, instead of a sample of its lines.
inline bool is_table_wanted() { return std::getenv("MONTECARTA_STUDIES") != nullptr; }

/// The lines of a table that are tested: all, or those that are a sample of it.
template <class Line, class IsSample>
std::vector<Line> tested_lines(std::vector<Line> lines, const IsSample& is_sample) {
  if (!is_table_wanted()) std::erase_if(lines, [&](const Line& line) { return !is_sample(line); });
  return lines;
}

/// Number of studies that a line is simulated from: `usual`, or the value of MONTECARTA_STUDIES.
/// Prints where the whole table is if this is a sample of it.
inline std::uint64_t studies_of_a_line(std::uint64_t usual) {
  const char* const text = std::getenv("MONTECARTA_STUDIES");
  if (text != nullptr) return std::stoull(text);
  std::printf(
      "a sample: analysis/STATISTICS.md has the whole table as last simulated, and the command\n");
  return usual;
}

/// Share of `studies` for which `is_so(study)` holds.
template <class Predicate>
double share_of_studies(std::uint64_t studies, const Predicate& is_so) {
  double n = 0.0;
  for (std::uint64_t study = 0; study < studies; ++study) n += is_so(study) ? 1.0 : 0.0;
  return n / static_cast<double>(studies);
}

/// `deviations` standard errors of a share of so many studies.
inline double share_errors(double share, std::uint64_t studies, double deviations = 3.0) {
  return deviations * std::sqrt(share * (1.0 - share) / static_cast<double>(studies));
}

/// The dependence of the errors of one run on each other.
enum class Memory {
  white,
  ar95,   ///< autoregression, 0.95 from scan to scan
  ar995,  ///< autoregression, 0.995
  constant,
  one_slow,            ///< the first component constant, the others white
  constant_and_white,  ///< a constant part of 0.3 of the variance, the rest white
  half_constant,       ///< constant in the first half, then white
  growing,             ///< a random walk, in units of its own deviation
  turned               ///< a constant and a white component, in a frame turned by 45 degrees
};

inline constexpr std::array kMemories = {
    Memory::white,         Memory::ar95,     Memory::ar995,
    Memory::constant,      Memory::one_slow, Memory::constant_and_white,
    Memory::half_constant, Memory::growing,  Memory::turned};

inline const char* name_of(Memory memory) {
  constexpr std::array kNames = {"white",         "AR(1) 0.95", "AR(1) 0.995",
                                 "constant",      "one slow",   "constant and white",
                                 "half constant", "growing",    "turned"};
  return kNames[static_cast<std::size_t>(memory)];
}

/// The law of the numbers that errors are made of; all have variance 1.
enum class Noise { gaussian, t5, t10, laplace, uniform, mixture };

inline constexpr std::array kNoises = {Noise::gaussian, Noise::t5,      Noise::t10,
                                       Noise::laplace,  Noise::uniform, Noise::mixture};

inline const char* name_of(Noise noise) {
  constexpr std::array kNames = {"Gaussian", "t5", "t10", "Laplace", "uniform", "mixture"};
  return kNames[static_cast<std::size_t>(noise)];
}

/// Student's t of so many degrees of freedom, divided by its deviation.
inline double draw_t(int freedom, RngStream& draw) {
  double squares = 0.0;
  const double normal = draw.normal();
  for (int k = 0; k < freedom; ++k) squares += std::pow(draw.normal(), 2);
  return normal / std::sqrt(squares / (freedom - 2));
}

inline double draw_noise(Noise noise, RngStream& draw) {
  switch (noise) {
    case Noise::t5:
      return draw_t(5, draw);
    case Noise::t10:
      return draw_t(10, draw);
    case Noise::laplace:
      return std::copysign(std::log(1.0 - draw.uniform()) / std::sqrt(2.0), draw.uniform() - 0.5);
    case Noise::uniform:
      return std::sqrt(12.0) * (draw.uniform() - 0.5);
    case Noise::mixture:
      return (draw.uniform() < 0.1 ? 3.0 : 1.0) * draw.normal() / std::sqrt(1.8);
    default:
      return draw.normal();
  }
}

/// Studies of a filter with Gaussian errors of the reported covariance but for the planted faults:
/// ratios of the variance by component, run and scan, a bias, and a correlation.
struct PlantedLaw {
  std::size_t dimension = 3;
  Memory memory = Memory::white;
  Noise noise = Noise::gaussian;
  double ratio = 1.0;
  std::vector<double> by_component = {};  ///< ratios; empty: 1
  std::vector<double> scales = {};        ///< of which each run draws its own ratio
  double log_scale = 0.0;  ///< deviation of the logarithm of ratios that runs have of their own
  double first_half = 1.0, second_half = 1.0;
  double bias = 0.0;          ///< of every component, in reported deviations
  double covered_bias = 0.0;  ///< likewise, and the reported covariance is larger by its square
  double correlation = 0.0;   ///< of the first two components, which the filter does not report
  bool cancels = false;       ///< the second half has the opposite bias and correlation, and the
                              ///< ratios 2 - by_component
};

/// One component at all scans.
inline std::vector<double> draw_component(const PlantedLaw& law, std::size_t component,
                                          std::size_t scans, RngStream& draw) {
  const Memory memory = law.memory;
  const auto next = [&] { return draw_noise(law.noise, draw); };
  std::vector<double> values;
  const double constant = next();
  double state = next();
  const auto step = [&](double correlation) {
    if (!values.empty()) {
      state = correlation * state + std::sqrt(1.0 - correlation * correlation) * next();
    }
    return state;
  };
  for (std::size_t s = 0; s < scans; ++s) {
    const bool is_slow = memory == Memory::one_slow || memory == Memory::turned;
    const bool is_constant = memory == Memory::constant || (is_slow && component == 0) ||
                             (memory == Memory::half_constant && 2 * s < scans);
    if (is_constant) {
      values.push_back(constant);
    } else if (memory == Memory::ar95 || memory == Memory::ar995) {
      values.push_back(step(memory == Memory::ar95 ? 0.95 : 0.995));
    } else if (memory == Memory::constant_and_white) {
      values.push_back(std::sqrt(0.3) * constant + std::sqrt(0.7) * next());
    } else if (memory == Memory::growing) {
      if (s > 0) state += next();
      values.push_back(state / std::sqrt(static_cast<double>(s + 1)));
    } else {
      values.push_back(next());
    }
  }
  return values;
}

/// The ratio that a run has of its own, with an expectation of 1.
inline double draw_scale(const PlantedLaw& law, RngStream& draw) {
  const double log_scale = law.log_scale;
  double scale = std::exp(log_scale * draw.normal() - 0.5 * log_scale * log_scale);
  const auto n = static_cast<double>(law.scales.size());
  if (n > 0.0) scale *= law.scales[static_cast<std::size_t>(n * draw.uniform())];
  return scale;
}

/// Plants the faults of one scan into its errors `e`.
inline void plant(const PlantedLaw& law, bool is_second_half, double scale, std::span<double> e) {
  const double sign = law.cancels && is_second_half ? -1.0 : 1.0;
  const double of_half = is_second_half ? law.second_half : law.first_half;
  for (std::size_t k = 0; k < e.size(); ++k) {
    double of_component = law.by_component.empty() ? 1.0 : law.by_component[k];
    if (sign < 0.0) of_component = 2.0 - of_component;
    e[k] = std::sqrt(law.ratio * of_component * scale * of_half) * e[k] + sign * law.bias;
    e[k] = (e[k] + sign * law.covered_bias) / std::sqrt(1.0 + law.covered_bias * law.covered_bias);
  }
  if (law.correlation == 0.0) return;
  const double common = sign * law.correlation;
  e[1] = common * e[0] + std::sqrt(1.0 - common * common) * e[1];
}

/// Errors of one run in units of the reported covariance, which has no correlations.
inline WhitenedRun drawn_run(const PlantedLaw& law, std::uint64_t study, std::uint64_t run,
                             std::size_t scans) {
  RngStream draw({.seed = study, .run = run, .purpose = Draw::test});
  const std::size_t d = law.dimension;
  WhitenedRun errors{d, std::vector<double>(scans * d), {}};
  errors.number = run;
  for (std::size_t k = 0; k < d; ++k) {
    const std::vector<double> values = draw_component(law, k, scans, draw);
    for (std::size_t s = 0; s < scans; ++s) errors.whitened[s * d + k] = values[s];
  }
  const double scale = draw_scale(law, draw);
  for (std::size_t s = 0; s < scans; ++s) {
    const auto e = std::span(errors.whitened).subspan(s * d, d);
    if (law.memory == Memory::turned && d > 1) {
      const double x = e[0], y = e[1];
      e[0] = (x + y) / std::sqrt(2.0);
      e[1] = (x - y) / std::sqrt(2.0);
    }
    plant(law, 2 * s >= scans, scale, e);
  }
  errors.standardised = errors.whitened;
  return errors;
}

inline std::vector<double> nees_of(const WhitenedRun& errors) {
  std::vector<double> nees(errors.whitened.size() / errors.dimension);
  for (std::size_t i = 0; i < errors.whitened.size(); ++i) {
    nees[i / errors.dimension] += errors.whitened[i] * errors.whitened[i];
  }
  return nees;
}

/// Adds up `runs` runs behind the `first` ones.
inline void add_runs(const PlantedLaw& law, std::uint64_t study, std::uint64_t first,
                     std::uint64_t runs, std::size_t scans, WholeError& sums) {
  for (std::uint64_t run = first; run < first + runs; ++run) {
    const WhitenedRun errors = drawn_run(law, study, run, scans);
    sums.add(errors, nees_of(errors));
  }
}

/// "a", "b", ...
inline std::vector<std::string> letters(std::size_t n) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < n; ++k) names.push_back(std::string(1, static_cast<char>('a' + k)));
  return names;
}

inline Verdict verdict_of(const WholeError& sums, std::size_t dimension, std::size_t scans,
                          std::uint64_t runs, double within = kUsualMargin, double level = 0.95) {
  const std::vector<std::string> components = letters(dimension);
  const std::vector<double> times = scan_times(scans);
  const ErrorNames names{components, times};
  return judge(sums.families(level, names), level, within, runs, sums.beside_tests(names));
}

inline Verdict verdict_of(const PlantedLaw& law, std::uint64_t study, std::uint64_t runs,
                          std::size_t scans, double within = kUsualMargin) {
  WholeError sums(law.dimension, scans);
  add_runs(law, study, 0, runs, scans, sums);
  return verdict_of(sums, law.dimension, scans, runs, within);
}

/// Returns whether some family rejects that is part of the answer, without regard to the margin.
inline bool is_rejected(const Verdict& verdict) {
  return std::ranges::any_of(verdict.families, [](const FamilyTest& test) {
    return test.is_rejected && test.family != Family::tails;
  });
}

inline bool is_rejected(const Verdict& verdict, Family family) {
  const FamilyTest* test = verdict.find(family);
  return test != nullptr && test->is_rejected;
}

}  // namespace montecarta::analysis
