// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "engine/text/number_text.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cstdint>

namespace montecarta::filters {

/// Returns whether the average NEES of a pose over `runs` runs is one that a consistent filter has,
/// within five standard errors. Says in which direction it is off, and by how much.
inline testing::AssertionResult is_consistent(double anees, std::uint64_t runs) {
  constexpr double kLevel = 1.0 - 5.7e-7;
  const analysis::Interval band = analysis::nees_bounds(runs, 3, kLevel);
  if (anees >= band.lower && anees <= band.upper) return testing::AssertionSuccess();
  return testing::AssertionFailure()
         << (anees < band.lower ? "conservative" : "optimistic") << ": ANEES "
         << analysis::readable(anees) << " where 3 is expected (" << analysis::readable(band.lower)
         << " to " << analysis::readable(band.upper) << " over " << runs << " runs)";
}

/// Errors of the poses at the end of some runs.
struct FinalErrors {
  double squared = 0.0;  ///< mean of squared distances [m^2]
  double anees = 0.0;    ///< mean NEES
};

/// The seeds of the runs count up from that of `settings`.
inline FinalErrors final_errors(SlamFilter& filter, SmallWorldSettings settings,
                                std::uint64_t runs) {
  FinalErrors mean;
  for (std::uint64_t run = 0; run < runs; ++run, ++settings.seed) {
    const SmallWorld world = small_world(settings);
    drive_through(filter, world, Pose(), [](std::size_t) {});
    const PoseMoments belief = filter.estimate().spread;
    const Eigen::Vector3d error = boxminus(world.drive.truth.back(), belief.mean);
    mean.squared += error.head<2>().squaredNorm() / static_cast<double>(runs);
    mean.anees += error.dot(belief.covariance.llt().solve(error)) / static_cast<double>(runs);
  }
  return mean;
}

}  // namespace montecarta::filters
