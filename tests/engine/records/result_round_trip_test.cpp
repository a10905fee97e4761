// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_file.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace montecarta::engine {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

/// Bit by bit, so that NaN equals NaN.
bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

class ResultRoundTrip : public ::testing::Test {
 protected:
  void SetUp() override { write_result(path_, plan_); }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  StudyPlan plan_ = small_result_plan();
};

TEST_F(ResultRoundTrip, HandsBackWhatTheStudyIs) {
  const ResultFile file(path_);
  EXPECT_EQ(file.study_name(), plan_.name);
  EXPECT_EQ(file.title(), plan_.title);
  EXPECT_EQ(file.study_text(), plan_.resolved_text);
  EXPECT_EQ(file.seed(), plan_.seed);
  EXPECT_EQ(file.study_runs(), plan_.runs);
  EXPECT_EQ(file.scenario(), plan_.scenario);
  EXPECT_THAT(file.runs(), ElementsAre(0U, 1U, 2U));
  EXPECT_EQ(file.times(), plan_.drives->itinerary().step_time);
  EXPECT_EQ(file.scan_rows(), plan_.drives->itinerary().scan_step);
  EXPECT_THAT(file.landmarks(),
              ElementsAre(std::pair(1.0, 2.0), std::pair(3.0, -1.0), std::pair(5.0, 0.5)));
  EXPECT_THAT(file.waypoints(), ElementsAre(std::pair(0.0, 0.0), std::pair(10.0, 0.0)));
  EXPECT_THAT(file.provenance(),
              ElementsAre(std::pair<std::string, std::string>("host", "nowhere")));
}

TEST_F(ResultRoundTrip, HandsBackTheCellsInTheirOrder) {
  const ResultFile file(path_);
  ASSERT_EQ(file.cells().size(), 2U);
  EXPECT_EQ(file.cells()[0].label, "scripted_m4");
  EXPECT_EQ(file.cells()[1].label, "scripted_m3");
  EXPECT_EQ(file.cells()[1].particles, 3U);
  EXPECT_EQ(file.cells()[1].settings, plan_.cells[1].settings);
  EXPECT_TRUE(file.cells()[0].has("pose_covariance_mixture"));
  EXPECT_THAT(file.status(file.cells()[0]), Each(RunStatus::complete));
  EXPECT_THAT(file.cpu_seconds(file.cells()[0]), ElementsAre(0.25, 1.25, 2.25));
}

TEST_F(ResultRoundTrip, HandsBackEveryColumnOfEveryRunBitByBit) {
  const ResultFile file(path_);
  for (std::size_t cell = 0; cell < plan_.cells.size(); ++cell) {
    const RecordLayout layout(plan_.cells[cell], plan_.columns, plan_.drives->itinerary());
    ASSERT_EQ(file.cells()[cell].columns.size(), layout.columns().size());
    RunRecord record(layout);
    Drive drive;
    for (std::uint64_t run = 0; run < plan_.runs; ++run) {
      plan_.drives->generate(run, drive);
      fill_record(plan_, cell, run, drive, record);
      for (std::size_t c = 0; c < layout.columns().size(); ++c) {
        const Column& column = layout.columns()[c];
        if (column.element != Element::f64) continue;
        std::vector<double> read(column.elements());
        file.read(file.cells()[cell], column.name, run, read);
        EXPECT_TRUE(same_bits(read, record.column<double>(c))) << column.name << " of run " << run;
      }
    }
  }
}

TEST_F(ResultRoundTrip, ConvertsSmallNumbers) {
  const ResultFile file(path_);
  const RecordLayout layout(plan_.cells[0], plan_.columns, plan_.drives->itinerary());
  RunRecord record(layout);
  Drive drive;
  plan_.drives->generate(2, drive);
  fill_record(plan_, 0, 2, drive, record);
  const auto stored = record.column<std::uint16_t>(*layout.find("ancestor"));
  std::vector<std::uint32_t> ancestor(stored.size());
  file.read(file.cells()[0], "ancestor", 2, ancestor);
  EXPECT_TRUE(std::ranges::equal(ancestor, stored));
  std::vector<double> as_double(stored.size());
  file.read(file.cells()[0], "ancestor", 2, as_double);
  EXPECT_TRUE(std::ranges::equal(as_double, stored));
}

TEST_F(ResultRoundTrip, HandsBackTheTruePath) {
  const ResultFile file(path_);
  Drive drive;
  plan_.drives->generate(1, drive);
  std::vector<double> truth(3 * drive.truth.size());
  file.read_truth(1, truth);
  EXPECT_EQ(std::memcmp(truth.data(), drive.truth.data(), truth.size() * sizeof(double)), 0);
}

TEST_F(ResultRoundTrip, NamesAColumnThatIsNotThere) {
  const ResultFile file(path_);
  std::vector<double> out(1);
  try {
    file.read(file.cells()[0], "pose_meen", 0, out);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("pose_meen"));
  }
}

TEST(ResultWithoutScansBetween, HoldsRowsAtScansOnly) {
  const ScratchFolder folder;
  StudyPlan plan = small_result_plan();
  plan.columns.scans_only = true;
  write_result(folder / "out.h5", plan);
  const ResultFile file(folder / "out.h5");
  const Itinerary& itinerary = plan.drives->itinerary();
  ASSERT_EQ(file.times().size(), itinerary.scans());
  EXPECT_EQ(file.times()[1], itinerary.step_time[itinerary.scan_step[1]]);
  EXPECT_EQ(file.scan_rows()[1], 1U);
  Drive drive;
  plan.drives->generate(1, drive);
  std::vector<double> truth(3 * itinerary.scans());
  file.read_truth(1, truth);
  EXPECT_EQ(truth[3], drive.truth[itinerary.scan_step[1]].x);
}

}  // namespace
}  // namespace montecarta::engine
