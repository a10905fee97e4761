// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The effect of differential evolution on one population at one scan (EQUATIONS (9.3)).
struct EvolutionEffect {
  std::size_t members = 0;   ///< number of members
  double generations = 0.0;  ///< number of generations until the evolution ended
  double gain = 0.0;  ///< log fitness of what the filter uses, after minus before evolution [1]
  double displacement = 0.0;  ///< how far that was moved, in standard deviations
};

/// The columns evolution_* of one scan, for filters that evolve.
class EvolutionReport {
 public:
  /// Declares the columns, in the order of values().
  static std::vector<OwnColumn> columns();
  /// Removes the columns from the reports of a filter that, by its options, does not evolve.
  static void remove_columns(Capabilities& reports);

  /// Begins a scan: nothing has evolved, and all values are zero.
  void begin_scan();
  void add(const EvolutionEffect& effect);
  /// Ends the scan: generations, gain and displacement become means over the populations.
  void end_scan();
  /// Number of evaluations of the fitness, mean number of generations, gain and displacement.
  std::span<const double> values() const { return values_; }

 private:
  std::array<double, 4> values_{};
  std::size_t populations_ = 0;
};

}  // namespace montecarta::filters
