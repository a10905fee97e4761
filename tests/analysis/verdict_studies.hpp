// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Returns whether a whole table of rates is asked for, instead of a sample of its lines.
inline bool is_table_wanted() { return std::getenv("MONTECARTA_STUDIES") != nullptr; }

inline constexpr const char* kHowToGetTheTable = "of the whole table: set MONTECARTA_STUDIES=2000";

/// Number of studies that a line is simulated from: `usual`, or the value of MONTECARTA_STUDIES.
inline std::uint64_t studies_of_a_line(std::uint64_t usual) {
  const char* const text = std::getenv("MONTECARTA_STUDIES");
  return text == nullptr ? usual : std::stoull(text);
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
  growing              ///< a random walk, in units of its own deviation
};

inline constexpr std::array kMemories = {Memory::white,         Memory::ar95,
                                         Memory::ar995,         Memory::constant,
                                         Memory::one_slow,      Memory::constant_and_white,
                                         Memory::half_constant, Memory::growing};

inline const char* name_of(Memory memory) {
  constexpr std::array kNames = {"white",    "AR(1) 0.95",         "AR(1) 0.995",   "constant",
                                 "one slow", "constant and white", "half constant", "growing"};
  return kNames[static_cast<std::size_t>(memory)];
}

/// Studies of a filter with Gaussian errors of the reported covariance but for the planted faults:
/// ratios of the variance by component, run and scan, a bias, and a correlation.
struct PlantedLaw {
  std::size_t dimension = 3;
  Memory memory = Memory::white;
  double ratio = 1.0;
  std::vector<double> by_component = {};  ///< ratios; empty: 1
  double even_runs = 1.0, odd_runs = 1.0;
  double first_half = 1.0, second_half = 1.0;
  double bias = 0.0;          ///< of every component, in reported deviations
  double covered_bias = 0.0;  ///< likewise, and the reported covariance is larger by its square
  double correlation = 0.0;   ///< of the first two components, which the filter does not report
};

/// One component at all scans.
inline std::vector<double> draw_component(Memory memory, std::size_t component, std::size_t scans,
                                          RngStream& draw) {
  std::vector<double> values;
  const double constant = draw.normal();
  double state = draw.normal();
  const auto step = [&](double correlation) {
    if (!values.empty()) {
      state = correlation * state + std::sqrt(1.0 - correlation * correlation) * draw.normal();
    }
    return state;
  };
  for (std::size_t s = 0; s < scans; ++s) {
    const bool is_constant = memory == Memory::constant ||
                             (memory == Memory::one_slow && component == 0) ||
                             (memory == Memory::half_constant && 2 * s < scans);
    if (is_constant) {
      values.push_back(constant);
    } else if (memory == Memory::ar95 || memory == Memory::ar995) {
      values.push_back(step(memory == Memory::ar95 ? 0.95 : 0.995));
    } else if (memory == Memory::constant_and_white) {
      values.push_back(std::sqrt(0.3) * constant + std::sqrt(0.7) * draw.normal());
    } else if (memory == Memory::growing) {
      if (s > 0) state += draw.normal();
      values.push_back(state / std::sqrt(static_cast<double>(s + 1)));
    } else {
      values.push_back(draw.normal());
    }
  }
  return values;
}

/// Errors of one run in units of the reported covariance, which has no correlations.
inline WhitenedRun drawn_run(const PlantedLaw& law, std::uint64_t study, std::uint64_t run,
                             std::size_t scans) {
  RngStream draw({.seed = study, .run = run, .purpose = Draw::test});
  const std::size_t d = law.dimension;
  WhitenedRun errors{d, std::vector<double>(scans * d), {}};
  for (std::size_t k = 0; k < d; ++k) {
    const std::vector<double> values = draw_component(law.memory, k, scans, draw);
    const double of_component = law.by_component.empty() ? 1.0 : law.by_component[k];
    const double of_run = run % 2 == 0 ? law.even_runs : law.odd_runs;
    for (std::size_t s = 0; s < scans; ++s) {
      const double of_scan = 2 * s < scans ? law.first_half : law.second_half;
      double& error = errors.whitened[s * d + k];
      error = std::sqrt(law.ratio * of_component * of_run * of_scan) * values[s] + law.bias;
      error = (error + law.covered_bias) / std::sqrt(1.0 + law.covered_bias * law.covered_bias);
      if (k != 1 || law.correlation == 0.0) continue;
      const double common = law.correlation;
      error = common * errors.whitened[s * d] + std::sqrt(1.0 - common * common) * error;
    }
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

inline Verdict verdict_of(const WholeError& sums, std::size_t dimension, std::size_t scans,
                          std::uint64_t runs, double within = kUsualMargin, double level = 0.95) {
  const std::vector<std::string> components = {"a", "b", "c", "d", "e", "f"};
  const std::vector<double> times = scan_times(scans);
  const auto names = std::span(components).first(dimension);
  return judge(sums.families(level, {names, times}), level, within, runs);
}

inline Verdict verdict_of(const PlantedLaw& law, std::uint64_t study, std::uint64_t runs,
                          std::size_t scans, double within = kUsualMargin) {
  WholeError sums(law.dimension, scans);
  add_runs(law, study, 0, runs, scans, sums);
  return verdict_of(sums, law.dimension, scans, runs, within);
}

/// Returns whether some family rejects, without regard to the margin.
inline bool is_rejected(const Verdict& verdict) {
  return std::ranges::any_of(verdict.families, &FamilyTest::is_rejected);
}

}  // namespace montecarta::analysis
