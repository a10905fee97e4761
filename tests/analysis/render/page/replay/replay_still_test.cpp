// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/replay/replay_still.hpp"

#include "analysis/render/page/replay/replay.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& wanted, const std::string& text) {
  std::size_t found = 0;
  for (std::size_t at = text.find(wanted); at != text.npos; at = text.find(wanted, at + 1)) ++found;
  return found;
}

/// Two cells with everything.
class ReplayStill : public testing::Test {
 protected:
  ReplayStill() : file((write_synthetic_result(folder / "out.h5", 3, 120), folder / "out.h5")) {}

  ScratchFolder folder;
  ResultFile file;
};

TEST_F(ReplayStill, HasAPanelACellWithAllThatIsStored) {
  const Replay replay = read_replay(file, 1);
  const std::string svg = replay_still(replay);
  EXPECT_EQ(svg.find("<svg xmlns=\"http://www.w3.org/2000/svg\""), 0U);
  EXPECT_EQ(count_of("<svg", svg), count_of("</svg>", svg));
  EXPECT_EQ(count_of("<svg", svg), 1U + 2U * replay.cells.size());  // whole and close up
  std::size_t particles = 0, landmarks = 0;
  for (const ReplayCell& cell : replay.cells) {
    EXPECT_THAT(svg, HasSubstr(">" + cell.label + "</text>"));
    particles += cell.particles.frames.back().x.size();
    landmarks += replay.landmarks.size();
  }
  // Once or, where they are close to the vehicle, twice; and a dot before each name.
  const std::size_t dots = count_of("<circle", svg) - replay.cells.size();
  EXPECT_TRUE(particles <= dots && dots <= 2U * particles) << dots << " of " << particles;
  const std::size_t ellipses = count_of("<ellipse", svg), all = landmarks + replay.cells.size();
  EXPECT_TRUE(all <= ellipses && ellipses <= 2U * all) << ellipses << " of " << all;
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST_F(ReplayStill, IsTheSameEveryTime) {
  EXPECT_EQ(replay_still(read_replay(file, 1)), replay_still(read_replay(file, 1)));
}

TEST_F(ReplayStill, ShowsARunThatFailedAndHasNoNumbers) {
  Replay replay = read_replay(file, 2);
  ASSERT_FALSE(replay.cells[1].failure.empty());
  for (double& x : replay.cells[0].x) x = std::numeric_limits<double>::quiet_NaN();
  for (double& x : replay.x) x = std::numeric_limits<double>::infinity();
  const std::string svg = replay_still(replay);
  EXPECT_THAT(svg, HasSubstr(">failed</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST_F(ReplayStill, EndsALineWhereItsNumbersEnd) {
  Replay replay = read_replay(file, 1);
  std::vector<double>& x = replay.cells[0].x;
  std::fill(x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end(),
            std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(replay_still(replay), Not(HasSubstr("L0 ")));
}

TEST_F(ReplayStill, LeavesOutALandmarkThatIsNoLongerInTheMap) {
  Replay replay = read_replay(file, 1);
  const std::size_t before = count_of("<ellipse", replay_still(replay));
  ReplayMap::DrawnLandmark gone = replay.cells[0].maps.back().changed.front();
  gone.ellipse.major = std::numeric_limits<double>::quiet_NaN();
  replay.cells[0].maps.push_back({replay.times.size() - 1, {gone}});
  EXPECT_LT(count_of("<ellipse", replay_still(replay)), before);
}

TEST_F(ReplayStill, HasRoomForFourCells) {
  Replay replay = read_replay(file, 1);
  replay.cells.resize(7, replay.cells.front());
  EXPECT_EQ(count_of("<svg", replay_still(replay)), 1U + 2U * 4U);
  replay.cells.clear();
  EXPECT_EQ(replay_still(replay), "");
}

TEST(ReplayStillOfARecordedDrive, HasNoTruthAndNoNees) {
  const ScratchFolder folder;
  write_recorded_result(folder / "out.h5", 2, 60);
  const std::string svg = replay_still(read_replay(ResultFile(folder / "out.h5"), 0));
  EXPECT_THAT(svg, Not(HasSubstr("NEES")));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
}

}  // namespace
}  // namespace montecarta::analysis
