// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/parallel.hpp"

#include <gtest/gtest.h>

namespace montecarta::engine {
namespace {

TEST(SpareThreads, AreLentOnceAWorkerHasNothingToDo) {
  const Parallel parallel(Backend::tbb, 2);
  SpareThreads spare(parallel, 2);
  EXPECT_EQ(&spare.lend(1000), &Parallel::serial());
  spare.gain_one();
  EXPECT_EQ(&spare.lend(1000), &parallel);
}

TEST(SpareThreads, AreLentFromTheStartWhereRunsAreFewer) {
  const Parallel parallel(Backend::tbb, 4);
  EXPECT_EQ(&SpareThreads(parallel, 3).lend(1000), &parallel);
}

TEST(SpareThreads, DoNotPayForFewParticles) {
  const Parallel parallel(Backend::tbb, 2);
  const SpareThreads spare(parallel, 1);
  EXPECT_EQ(&spare.lend(SpareThreads::kLeastParticles - 1), &Parallel::serial());
  EXPECT_EQ(&spare.lend(SpareThreads::kLeastParticles), &parallel);
}

}  // namespace
}  // namespace montecarta::engine
