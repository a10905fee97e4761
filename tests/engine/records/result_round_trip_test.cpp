// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/result_writing.hpp"
#include "tests/doubles/same_results.hpp"

#include <cstring>

namespace montecarta::engine {
namespace {

class ResultRoundTrip : public ResultWriting {
 protected:
  void SetUp() override { write_result(path_, plan_); }
};

TEST_F(ResultRoundTrip, HandsBackTheStudyAndItsCellsInTheirOrder) {
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
  EXPECT_THAT(file.landmarks(), ElementsAre(Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(3.0, -1.0),
                                            Eigen::Vector2d(5.0, 0.5)));
  EXPECT_THAT(file.waypoints(), ElementsAre(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(10.0, 0.0)));
  EXPECT_THAT(file.provenance(),
              ElementsAre(std::pair<std::string, std::string>("host", "nowhere")));
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
    for (std::uint64_t run = 0; run < plan_.runs; ++run) {
      FilledRecord filled(plan_, cell, run);
      const auto& columns = filled.layout.columns();
      ASSERT_EQ(file.cells()[cell].columns.size(), columns.size());
      for (const Column& column : columns) {
        if (column.element != Element::f64) continue;
        std::vector<double> read(column.elements());
        file.read(file.cells()[cell], column.name, run, read);
        EXPECT_TRUE(same_bits(read, filled.column<double>(column.name))) << column.name << run;
      }
    }
  }
}

TEST_F(ResultRoundTrip, ConvertsSmallNumbers) {
  const ResultFile file(path_);
  FilledRecord filled(plan_, 0, 2);
  const auto stored = filled.column<std::uint16_t>("ancestor");
  std::vector<std::uint32_t> ancestor(stored.size());
  file.read(file.cells()[0], "ancestor", 2, ancestor);
  EXPECT_TRUE(std::ranges::equal(ancestor, stored));
  std::vector<double> as_double(stored.size());
  file.read(file.cells()[0], "ancestor", 2, as_double);
  EXPECT_TRUE(std::ranges::equal(as_double, stored));
}

TEST_F(ResultRoundTrip, HandsBackTheTruePathAndNamesAColumnThatIsNotThere) {
  const ResultFile file(path_);
  Drive drive;
  plan_.drives->generate(1, drive);
  std::vector<double> truth(3 * drive.truth.size());
  file.read_truth(1, truth);
  EXPECT_EQ(std::memcmp(truth.data(), drive.truth.data(), truth.size() * sizeof(double)), 0);
  std::vector<double> out(1);
  EXPECT_THAT([&] { file.read(file.cells()[0], "pose_meen", 0, out); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("pose_meen")));
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

/// The scripted drive as if it had been recorded: nobody knows the truth, two instruments saw it.
class Recording final : public DriveSource {
 public:
  explicit Recording(std::vector<Eigen::Matrix3d> of_sun = {},
                     std::vector<Eigen::Matrix3d> of_gps = {})
      : drives_(24), itinerary_(drives_.itinerary()) {
    itinerary_.has_truth = false;
    itinerary_.references = {{"sun", {0.0, 0.3}, {{1.0, 2.0}, {3.0, 4.0}}, {0.1, -0.2}},
                             {"gps", {0.1, 0.2, 0.4}, {{5.0, 6.0}, {7.0, 8.0}, {9.0, 10.0}}, {}}};
    itinerary_.references[0].covariance = std::move(of_sun);
    itinerary_.references[1].covariance = std::move(of_gps);
  }
  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override {
    drives_.generate(run, drive);
    drive.truth.clear();
  }

 private:
  ScriptedDrives drives_;
  Itinerary itinerary_;
};

class RecordedResult : public ResultWriting {
 protected:
  RecordedResult() { plan_.drives = std::make_shared<Recording>(); }
};

TEST_F(RecordedResult, HandsBackItsReferencesAndNoTruth) {
  write_result(path_, plan_);
  const ResultFile file(path_);
  EXPECT_FALSE(file.has_truth());
  EXPECT_FALSE(h5::has(h5::open_file(path_), "truth"));
  ASSERT_EQ(file.references().size(), 2U);
  const ReferencePath& sun = file.references()[0];
  EXPECT_EQ(sun.name, "sun");
  EXPECT_THAT(sun.time, ElementsAre(0.0, 0.3));
  EXPECT_THAT(sun.heading, ElementsAre(0.1, -0.2));
  const ReferencePath& gps = file.references()[1];
  EXPECT_EQ(gps.name, "gps");
  EXPECT_TRUE(gps.covariance.empty());
  EXPECT_TRUE(gps.heading.empty());
  EXPECT_THAT(gps.position,
              ElementsAre(Eigen::Vector2d(5, 6), Eigen::Vector2d(7, 8), Eigen::Vector2d(9, 10)));
}

TEST_F(RecordedResult, HandsBackTheErrorsOfItsReferences) {
  const Eigen::Matrix3d pose{{4, 1, 0.2}, {1, 9, 0.3}, {0.2, 0.3, 0.25}};
  const Eigen::Matrix3d place{{4, 1, 0}, {1, 9, 0}, {0, 0, 0}};
  plan_.drives = std::make_shared<Recording>(std::vector{pose, Eigen::Matrix3d(2.0 * pose)},
                                             std::vector(3, place));
  write_result(path_, plan_);
  const ResultFile file(path_);
  EXPECT_THAT(file.references()[0].covariance, ElementsAre(pose, Eigen::Matrix3d(2.0 * pose)));
  EXPECT_THAT(file.references()[1].covariance, ElementsAre(place, place, place));
}

TEST_F(RecordedResult, ResumesAndMergesLikeAnyOther) {
  write_result(folder_ / "whole.h5", plan_);
  const ResultFile whole(folder_ / "whole.h5");
  begin();
  {
    ResultWriter writer = resume();
    for (std::uint64_t run = 1; run < plan_.runs; ++run) store_run(writer, plan_, run);
    writer.finish();
  }
  EXPECT_EQ(difference(whole, ResultFile(path_)), "");

  write_result(folder_ / "a.h5", part_of_plan(plan_, 0, 2));
  write_result(folder_ / "b.h5", part_of_plan(plan_, 1, 3));
  merge_results(folder_ / "merged.h5", {folder_ / "a.h5", folder_ / "b.h5"}, Existing::refuse);
  EXPECT_EQ(difference(whole, ResultFile(folder_ / "merged.h5")), "");
}

// One bit of a stored run changes: in a number, the true path, the status or the fingerprint.
TEST_F(RecordedResult, ExpectsEveryRunToFitItsFingerprint) {
  plan_ = small_result_plan();
  write_result(path_, plan_);
  const ResultSlabs slabs = find_slabs(path_, describe(plan_, {}));
  const auto is_whole = [&](std::size_t cell, std::size_t run) {
    const ResultFile file(path_);
    try {
      file.expect_whole(file.cells().at(cell), run);
      return true;
    } catch (const StudyError& error) {
      EXPECT_THAT(error.what(), HasSubstr("run 1: damaged"));
      return false;
    }
  };
  for (std::size_t run = 0; run < plan_.runs; ++run) EXPECT_TRUE(is_whole(0, run)) << run;
  for (const Slab& slab : {slabs.cells[0].columns[0], slabs.cells[0].columns[1], slabs.truth->pose,
                           slabs.truth->fingerprint, slabs.cells[0].fingerprint,
                           slabs.cells[0].status, slabs.cells[0].failure_step}) {
    flip_bit(path_, slab.at(1));
    EXPECT_FALSE(is_whole(0, 1)) << slab.offset;
    EXPECT_TRUE(is_whole(0, 2)) << slab.offset;
    flip_bit(path_, slab.at(1));
  }
  EXPECT_TRUE(is_whole(0, 1));
}

TEST_F(RecordedResult, DamageIsFoundWithoutATruthToo) {
  write_result(folder_ / "a.h5", part_of_plan(plan_, 0, 2));
  write_result(folder_ / "b.h5", part_of_plan(plan_, 2, 3));
  const auto slabs = find_slabs(folder_ / "a.h5", describe(part_of_plan(plan_, 0, 2), {}));
  flip_bit(folder_ / "a.h5", slabs.cells[0].columns[0].at(1));
  const std::string said = complaint_of([&] {
    merge_results(folder_ / "merged.h5", {folder_ / "a.h5", folder_ / "b.h5"}, Existing::refuse);
  });
  EXPECT_THAT(said, HasSubstr("run 1 is damaged"));
}

}  // namespace
}  // namespace montecarta::engine
