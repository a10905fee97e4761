// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/replay/replay.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ReadReplay : public testing::Test {
 protected:
  ReadReplay() : file((write_synthetic_result(folder / "out.h5", 3, 400), folder / "out.h5")) {}

  ScratchFolder folder;
  ResultFile file;
};

TEST_F(ReadReplay, EndsAtTheLastScanWhateverTheFramesAre) {
  for (const std::size_t most : {1u, 7u, 400u}) {
    const Replay replay = read_replay(file, 1, {.frames = most});
    EXPECT_LE(replay.times.size(), most);
    EXPECT_EQ(replay.times.back(), file.scan_times().back());
    EXPECT_TRUE(std::ranges::is_sorted(replay.times));
    for (const ReplayCell& cell : replay.cells) EXPECT_EQ(cell.x.size(), replay.times.size());
  }
}

TEST_F(ReadReplay, HoldsWhatTheFileHolds) {
  const Replay replay = read_replay(file, 1, {.frames = 1000});
  EXPECT_EQ(replay.run, 1u);
  ASSERT_EQ(replay.cells.size(), 2u);
  std::vector<double> truth(file.times().size() * 3), mean(truth.size());
  file.read_truth(1, truth);
  file.read(file.cells()[0], "pose_mean_mixture", 1, std::span(mean));
  for (std::size_t s = 0; s < replay.times.size(); ++s) {
    const std::size_t row = file.scan_rows()[s];
    EXPECT_EQ(replay.x[s], truth[3 * row]);
    EXPECT_EQ(replay.cells[0].y[s], mean[3 * row + 1]);
  }
  EXPECT_EQ(replay.cells[0].pose.size(), replay.times.size());
  EXPECT_EQ(replay.cells[0].particles.frames.back().shown.size(), 4u);
  EXPECT_EQ(replay.cells[0].maps.back().frame, replay.times.size() - 1);
}

TEST_F(ReadReplay, KnowsTheNeesOfACompleteRunAndHowFarToLook) {
  const Replay replay = read_replay(file, 1, {.frames = 1000});
  double sum = 0.0;
  for (const double value : replay.cells[0].nees) sum += value;
  const double average = sum / static_cast<double>(replay.cells[0].nees.size());
  EXPECT_NEAR(average, 1.0, 0.34);  // 50 scans
  EXPECT_NEAR(replay.cells[0].nees_band.lower, 0.2158 / 3.0, 1e-4);
  EXPECT_NEAR(replay.cells[0].nees_band.upper, 9.3484 / 3.0, 1e-4);
  std::size_t outside = 0;
  for (std::size_t f = 0; f < replay.times.size(); ++f) {
    const double error =
        std::hypot(replay.cells[0].x[f] - replay.x[f], replay.cells[0].y[f] - replay.y[f]);
    outside += error > replay.close_up ? 1U : 0U;
  }
  EXPECT_LT(outside, replay.times.size() / 5);
}

TEST_F(ReadReplay, TellsOfALandmarkWhenItChanges) {
  const std::vector<ReplayMap> maps = read_replay(file, 1, {.frames = 1000}).cells[0].maps;
  ASSERT_FALSE(maps.empty());
  const StoredMap stored(file, file.cells()[0], 1);
  std::vector<ReplayMap::DrawnLandmark> latest;
  for (std::size_t f = 0, k = 0; f < file.scan_times().size(); ++f) {
    for (; k < maps.size() && maps[k].frame <= f; ++k) {
      for (const ReplayMap::DrawnLandmark& landmark : maps[k].changed) {
        std::erase_if(latest, [&](const auto& old) { return old.row == landmark.row; });
        latest.push_back(landmark);
      }
    }
    ASSERT_EQ(latest.size(), stored.at(f).size()) << f;
    for (const auto& [row, shown] : latest) {
      const Ellipse there = *stored.at(f, row);
      EXPECT_NEAR(shown.x, there.x, 0.02);
      EXPECT_NEAR(shown.major, there.major * std::sqrt(-2.0 * std::log(0.05)) / 2.0, 0.02);
    }
  }
}

TEST_F(ReadReplay, EndsAFailedRunWhereItFailed) {
  const ReplayCell failed = read_replay(file, 2).cells.at(1);
  EXPECT_THAT(failed.failure, HasSubstr("failed at step 5: gain is <not> a number"));
  EXPECT_TRUE(std::isnan(failed.x.back()));
  EXPECT_FALSE(std::isnan(failed.x.front()));
}

TEST_F(ReadReplay, SharesItsRoomAmongTheCells) {
  ReplaySize small{.frames = 50};
  small.ellipses = 2;
  for (const ReplayCell& cell : read_replay(file, 0, small).cells) {
    EXPECT_EQ(cell.maps.size(), 1u);
  }
}

TEST(ReadReplayOfARecordedDrive, HasFixesAndNoTruth) {
  const ScratchFolder folder;
  write_recorded_result(folder / "out.h5", 2, 60);
  const Replay replay = read_replay(ResultFile(folder / "out.h5"), 0);
  EXPECT_THAT(replay.x, IsEmpty());
  EXPECT_FALSE(replay.fixes.empty());
  EXPECT_FALSE(replay.cells.empty());
}

TEST(ReplayJson, IsShortAndComplete) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Replay replay{7};
  replay.times = {0.2, 0.4};
  replay.x = {1, 2};
  replay.y = {3, 4};
  replay.h = {0.5, 0.25};
  replay.landmarks = {{10, -20}};
  ReplayCell cell{"pf", 1, "failed"};
  cell.x = {1.00049, nan};
  cell.y = {3, nan};
  cell.h = {0.123456, nan};
  cell.pose = {{1, 3, 0.5, 0.25, 45}, {nan, nan, nan, nan, nan}};
  cell.nees = {2.3456, nan};
  cell.nees_band = {0.25, 9.5};
  cell.particles = {9, {{{4}, {}, {1.1}, {2.9}, {0.25}}, {{5}, {0}, {nan}, {nan}, {nan}}}};
  cell.maps = {{1, {{6, {10, -20, 0.1, 0.05, 30}}}}};
  cell.has_ancestry = true;
  replay.cells = {cell};
  EXPECT_EQ(
      replay_json(replay),
      R"({"run":7,"close_up":1,"times":[0.2,0.4],"truth":{"x":[1,2],"y":[3,4],"h":[0.5,0.25]},)"
      R"("landmarks":[10,-20],"fixes":[],"cells":[{"label":"pf","failure":"failed",)"
      R"("colour":"#D55E00","ancestry":true,"x":[1.00049,null],"y":[3,null],)"
      R"("h":[0.1235,null],"pose":[0.5,0.25,45,null,null,null],"nees":[2.35,null],)"
      R"("band":[0.25,9.5],"particles":9,)"
      R"("clouds":[{"size":0.10001,"dots":"_r01","weight":"W"},)"  // 63 * 64 + 53 and 1; 32
      R"({"size":1e-09,"dots":"0000","parent":"00","weight":"0"}],)"
      R"("maps":[{"frame":1,"landmarks":[6,10,-20,0.1,0.05,30]}]}]})");
}

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
      const auto& [shown, parent, x, y, weight] = particles.frames[f];
      EXPECT_THAT(weight, IsEmpty());
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

TEST(ThinParticles, WeighByTheHeaviestOfAllShownOrNot) {
  const Genealogy family(3, 2, 1);
  const std::vector<double> log_weight = {0, 0, 0, std::log(0.1), std::log(0.6), std::log(0.3)};
  const ReplayParticles particles = thin_particles({3, family.pose, family.ancestor, log_weight},
                                                   std::vector<std::size_t>{0, 1}, 2);
  const auto& [shown, parent, x, y, weight] = particles.frames[1];
  ASSERT_THAT(shown, ElementsAre(0, 1));
  EXPECT_NEAR(weight[0], 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(weight[1], 1.0, 1e-12);
}

}  // namespace
}  // namespace montecarta::analysis
