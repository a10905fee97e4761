// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/replay.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Particles of random ancestry; the pose tells scan and index.
struct Genealogy {
  std::size_t count, scans;
  std::vector<double> pose;
  std::vector<std::uint32_t> ancestor;

  Genealogy(std::size_t particles, std::size_t all_scans, std::uint64_t seed)
      : count(particles), scans(all_scans) {
    RngStream draw({seed, 0, 0, 0, Draw::test});
    for (std::size_t k = 0; k < scans * count; ++k) {
      pose.insert(pose.end(), {static_cast<double>(k % count), static_cast<double>(k / count), 0});
      ancestor.push_back(static_cast<std::uint32_t>(draw.uniform() * static_cast<double>(count)));
    }
  }
  StoredParticles stored() const { return {count, pose, ancestor}; }
};

TEST(ThinParticles, ShowTheAncestorsOfAllThatAreShown) {
  const std::vector<std::size_t> scans = {0, 3, 4, 9, 19};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const Genealogy family(30, 20, seed);
    const ReplayParticles particles = thin_particles(family.stored(), scans, 8);
    ASSERT_EQ(particles.frames.size(), scans.size());
    for (std::size_t f = 0; f < scans.size(); ++f) {
      const auto& [shown, parent, x, y] = particles.frames[f];
      EXPECT_EQ(shown.size(), 8u);
      EXPECT_TRUE(std::ranges::is_sorted(shown));
      ASSERT_EQ(parent.size(), f == 0 ? 0u : 8u);
      for (std::size_t i = 0; i < shown.size(); ++i) {
        EXPECT_EQ(x[i], shown[i]);
        EXPECT_EQ(y[i], static_cast<double>(scans[f]));
        if (f == 0) continue;
        std::uint32_t ancestor = shown[i];
        for (std::size_t s = scans[f]; s > scans[f - 1]; --s) {
          ancestor = family.ancestor[s * family.count + ancestor];
        }
        EXPECT_EQ(particles.frames[f - 1].shown.at(parent[i]), ancestor);
      }
    }
  }
}

TEST(ThinParticles, ShowAllWhereThereIsRoom) {
  const Genealogy family(3, 2, 1);
  const ReplayParticles particles =
      thin_particles({3, family.pose, {}}, std::vector<std::size_t>{0, 1}, 100);
  EXPECT_EQ(particles.all, 3u);
  for (const auto& frame : particles.frames) {
    EXPECT_THAT(frame.shown, ElementsAre(0, 1, 2));
    EXPECT_THAT(frame.parent, IsEmpty());
  }
}

TEST(ThinParticles, RefuseAnAncestorThatIsNoParticle) {
  Genealogy family(3, 2, 1);
  family.ancestor[3] = 3;
  EXPECT_THROW(thin_particles(family.stored(), std::vector<std::size_t>{0, 1}, 100), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
