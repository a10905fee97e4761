// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/marginal_options.hpp"

#include <string>

namespace montecarta::filters {
namespace {

using Names = std::vector<std::string>;

// The order is that of the enumerators.
const Names kKernels{"prior", "posterior"};
const Names kModes{"onestep_converged", "onestep_threshold", "recursive"};
const Names kSolvers{"gauss_newton", "de"};
const Names kObjectives{"likelihood", "squares", "squares_as_printed"};
const Names kSums{"direct", "ifgt"};

}  // namespace

std::vector<Parameter> marginal_options(MapSolver solver) {
  return {
      count_parameter("particles", "100", 1, 1e6, "number of particles"),
      choice_parameter("kernel", "prior", kKernels,
                       "distribution that poses are drawn from (EQUATIONS 12)"),
      number_parameter(
          "kernel_floor_xy", "0.01", 0, 100,
          "standard deviation [m] of the noise added to x and y at every scan (EQUATIONS 12)"),
      number_parameter("kernel_floor_heading", "0.001", 0, 3,
                       "standard deviation [rad] of the noise added to the heading at every scan "
                       "(EQUATIONS 12)"),
      choice_parameter(
          "kernel_sums", "direct", kSums,
          "how the mixtures are summed: directly, or by the fast Gauss transform (EQUATIONS 13)"),
      number_parameter("kernel_tolerance", "1e-9", 1e-15, 0.1,
                       "with kernel_sums=ifgt: error of a sum, relative to the sum of all peaks"),
      choice_parameter("map", "recursive", kModes,
                       "how the estimate of a landmark uses earlier scans (EQUATIONS 14)"),
      choice_parameter("map_solver", kSolvers[static_cast<std::size_t>(solver)], kSolvers,
                       "method that optimises the position of a landmark"),
      choice_parameter(
          "map_objective", "likelihood", kObjectives,
          "objective of the position of a landmark (Havangi eq. 27, its bound, eq. 29)"),
      number_parameter("map_threshold", "5.991464547107979", 0, 1e6,
                       "with map=onestep_threshold: objective below which a landmark is not moved "
                       "(EQUATIONS 14)"),
      count_parameter("population", "30", 1, 10000,
                      "with map_solver=de: number of candidates for each landmark"),
      count_parameter("generations", "10", 0, 1000,
                      "with map_solver=de: largest number of generations (EQUATIONS 9)"),
      number_parameter("scale", "0.5", 0, 2,
                       "with map_solver=de: factor F of the difference vectors (EQUATIONS 9)"),
      number_parameter("crossover", "0.8", 0, 1,
                       "with map_solver=de: crossover rate Cr (EQUATIONS 9)"),
      choice_parameter(
          "base", "random", kEvolutionBases,
          "with map_solver=de: base of a trial; Havangi eq. (6) has random, eq. (30) target"),
  };
}

MapSettings map_settings(const FilterOptions& options) {
  return {.mode = chosen<MapMode>(options.choice("map"), kModes),
          .solver = chosen<MapSolver>(options.choice("map_solver"), kSolvers),
          .objective = chosen<MapObjective>(options.choice("map_objective"), kObjectives),
          .threshold = options.number("map_threshold"),
          .population = options.integer("population"),
          .evolution = {.scale = options.number("scale"),
                        .crossover = options.number("crossover"),
                        .generations = options.integer("generations"),
                        .base = chosen<EvolutionBase>(options.choice("base"), kEvolutionBases)}};
}

MarginalSettings marginal_settings(const FilterOptions& options, Choice choice) {
  return {.particles = options.integer("particles"),
          .choice = choice,
          .kernel = chosen<Kernel>(options.choice("kernel"), kKernels),
          .kernel_floor_xy = options.number("kernel_floor_xy"),
          .kernel_floor_heading = options.number("kernel_floor_heading"),
          .kernel_sums = chosen<KernelSums>(options.choice("kernel_sums"), kSums),
          .kernel_tolerance = options.number("kernel_tolerance"),
          .map = map_settings(options)};
}

}  // namespace montecarta::filters
