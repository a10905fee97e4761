// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/replay.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

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

}  // namespace
}  // namespace montecarta::analysis
