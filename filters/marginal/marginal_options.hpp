// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::filters {

/// From what the kernels are chosen that are drawn from (EQUATIONS (12.2)).
enum class Choice {
  by_weight,      ///< lambda = w: marginal particle filter
  by_likelihood,  ///< lambda = w p(z | m): auxiliary marginal particle filter
};
/// What poses are drawn from (EQUATIONS 12).
enum class Kernel {
  prior,      ///< the motion model
  posterior,  ///< the motion model refined by the scan
};
/// What a landmark remembers of earlier scans (EQUATIONS 14).
enum class MapMode {
  onestep_converged,  ///< nothing: the best explanation of this scan alone
  onestep_threshold,  ///< nothing, but it stays where it explains the scan well enough
  recursive,          ///< a quadratic summary of all of them
};
enum class MapSolver { gauss_newton, de };
/// What a landmark is judged by.
enum class MapObjective {
  likelihood,          ///< -2 log Sum w p(z | s): Havangi (27)
  squares,             ///< Sum w nu' R^-1 nu: its upper bound
  squares_as_printed,  ///< Sum nu' R^-1 nu / M: Havangi (29) forgets the weights
};
enum class KernelSums { direct, ifgt };

struct MapSettings {
  MapMode mode = MapMode::recursive;
  MapSolver solver = MapSolver::gauss_newton;
  MapObjective objective = MapObjective::likelihood;
  double threshold = 0.0;  ///< onestep_threshold: good enough
  std::size_t population = 30;
  EvolutionSettings evolution = {};
};

struct MarginalSettings {
  std::size_t particles = 100;
  Choice choice = Choice::by_weight;
  Kernel kernel = Kernel::prior;
  double kernel_floor_xy = 0.01;        ///< [m] noise added to x and y once a scan
  double kernel_floor_heading = 0.001;  ///< [rad]
  KernelSums kernel_sums = KernelSums::direct;
  double kernel_tolerance = 1e-9;  ///< ifgt: of the sum of all weights
  MapSettings map = {};
};

/// In the order in which they are documented; `solver` is the default way to learn the map.
std::vector<Parameter> marginal_options(MapSolver solver);
MarginalSettings marginal_settings(const FilterOptions& options, Choice choice);

}  // namespace montecarta::filters
