// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/factory.hpp"

#include <cstddef>
#include <memory>

/// The plain FastSLAM filters, made of their settings. fast_slams.cpp alone includes the filters
/// themselves: their Eigen expressions take the compiler longer than the tests that use them.
namespace montecarta::filters::reference {

enum class Scheme { systematic, stratified };

struct FastSlamSettings {
  std::size_t particles = 30;
  Scheme scheme = Scheme::systematic;
  double threshold = 0.5;  ///< resample where ESS < threshold times particles
  Belief belief = {};
  AssociationSettings association = {};
  std::size_t landmarks = 0;  ///< of the world, with known association
};

/// The three forms of EQUATIONS 6.
enum class Weight { closed, ratio, batch };

/// Parameters of the scaled unscented transform (EQUATIONS 7).
struct Unscented {
  double alpha = 0.9;
  double beta = 2.0;
  double kappa = 0.0;
};

/// Where SRCD-FastSLAM and its variants (EQUATIONS 8) use central differences; elsewhere they are
/// FastSLAM II.
struct SrcdParts {
  bool pose = true;
  bool map = true;
  bool map_uncertainty = true;
  double h = 1.7320508075688772;
};

/// What evolution moves in DE-SRCD-FastSLAM (EQUATIONS 10).
enum class DeMode { unbiased, as_printed, prior, shared };

struct DeSettings {
  DeMode mode = DeMode::unbiased;
  double scale = 0.4;
  double crossover = 0.8;
  std::size_t generations = 10;  ///< at most
  std::size_t population = 10;   ///< of each particle, mode unbiased
  double bounds = 3.0;           ///< standard deviations
  double inflation = 1.0;        ///< of the covariance that is drawn from and paid for
};

/// What an evolution decided so far.
struct EvolutionRecord {
  std::size_t accepted = 0;   ///< trials that moved in
  std::size_t decisions = 0;  ///< whether one does
  double closest_call = 1.0;  ///< least difference of fitness, but for none, of two places
};

std::unique_ptr<SlamFilter> make_fast_slam1(const FastSlamSettings& settings);
std::unique_ptr<SlamFilter> make_fast_slam2(const FastSlamSettings& settings, Weight weight);
std::unique_ptr<SlamFilter> make_ufast_slam(const FastSlamSettings& settings, Weight weight,
                                            const Unscented& unscented, bool map_uncertainty);
std::unique_ptr<SlamFilter> make_srcd_fast_slam(const FastSlamSettings& settings, Weight weight,
                                                const SrcdParts& parts);

/// DE-SRCD-FastSLAM, and what evolution decides in it.
struct EvolvedFilter {
  std::unique_ptr<SlamFilter> filter;
  const EvolutionRecord* record;  ///< the filter's own
};
EvolvedFilter make_de_srcd_fast_slam(const FastSlamSettings& settings, const DeSettings& de);

}  // namespace montecarta::filters::reference
