// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/marginal_filter.hpp"

namespace montecarta::filters {
namespace {

/// Without evolution of the map there is nothing to report about it.
void keep_columns_of_evolution(const FilterSetup& setup, Capabilities& reports) {
  if (map_settings(setup.options).solver != MapSolver::de) EvolutionReport::remove_columns(reports);
}

}  // namespace

FilterKind marginal_kind() {
  return {.name = "marginal",
          .long_name = "marginal particle filter with one map",
          .source = "Martinez-Cantin et al. 2007; Klaas et al. 2005; EQUATIONS 12",
          .reports = {.particles = true, .own_columns = EvolutionReport::columns()},
          .options = marginal_options(MapSolver::gauss_newton),
          .takes_prior = true,
          .restrict_reports = keep_columns_of_evolution,
          .make = make_marginal<Lanes, Choice::by_weight>};
}

FilterKind ampf_de_kind() {
  return {.name = "ampf_de",
          .long_name = "auxiliary marginal particle filter, map by DE",
          .source = "Havangi et al. 2013; EQUATIONS 12, 14",
          .reports = {.particles = true, .own_columns = EvolutionReport::columns()},
          .options = marginal_options(MapSolver::de),
          .takes_prior = true,
          .restrict_reports = keep_columns_of_evolution,
          .make = make_marginal<Lanes, Choice::by_likelihood>};
}

}  // namespace montecarta::filters
