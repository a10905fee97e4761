// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::filters {

/// The weights by which kernels are chosen for the draw (EQUATIONS (12.2)).
enum class Choice {
  by_weight,      ///< lambda = w: marginal particle filter
  by_likelihood,  ///< lambda = w p(z | m): auxiliary marginal particle filter
};
/// The kernels from which poses are drawn (EQUATIONS 12).
enum class Kernel {
  prior,      ///< the motion model
  posterior,  ///< the motion model refined by the scan
};
/// The information that a landmark keeps from earlier scans (EQUATIONS 14).
enum class MapMode {
  onestep_converged,  ///< no information: it becomes the best explanation of this scan alone
  onestep_threshold,  ///< no information, but it stays if it explains the scan well enough
  recursive,          ///< a quadratic summary of all earlier scans
};
enum class MapSolver { gauss_newton, de };
/// The objective of the position of a landmark (EQUATIONS 14).
enum class MapObjective {
  likelihood,          ///< -2 log Sum w p(z | s): Havangi (27)
  squares,             ///< Sum w nu' R^-1 nu: its upper bound
  squares_as_printed,  ///< Sum nu' R^-1 nu / M: Havangi (29), which omits the weights
};
enum class KernelSums { direct, ifgt };

struct MapSettings {
  MapMode mode = MapMode::recursive;
  MapSolver solver = MapSolver::gauss_newton;
  MapObjective objective = MapObjective::likelihood;
  double threshold = 0.0;  ///< for onestep_threshold: objective that suffices
  std::size_t population = 30;
  EvolutionSettings evolution = {};
};

struct MarginalSettings {
  std::size_t particles = 100;
  Choice choice = Choice::by_weight;
  Kernel kernel = Kernel::prior;
  double kernel_floor_xy = 0.01;        ///< [m] noise added to x and y at every scan
  double kernel_floor_heading = 0.001;  ///< [rad] noise added to the heading at every scan
  KernelSums kernel_sums = KernelSums::direct;
  double kernel_tolerance = 1e-9;  ///< for ifgt: error relative to the sum of all weights
  MapSettings map = {};
};

/// The options in the order of the documentation; `solver` is the default of map_solver.
std::vector<Parameter> marginal_options(MapSolver solver);
MapSettings map_settings(const FilterOptions& options);
MarginalSettings marginal_settings(const FilterOptions& options, Choice choice);

}  // namespace montecarta::filters
