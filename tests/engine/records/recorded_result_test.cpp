// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_slabs.hpp"
#include "tests/doubles/result_writing.hpp"
#include "tests/doubles/same_results.hpp"

#include <gmock/gmock.h>

namespace montecarta::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST_F(RecordedResult, ASimulatedOneHasTruthAndNoReferences) {
  plan_ = small_result_plan();
  write_result(path_, plan_);
  const ResultFile file(path_);
  EXPECT_TRUE(file.has_truth());
  EXPECT_TRUE(file.references().empty());
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

// One bit in what is stored of a run: a number, the true path, the status, the fingerprint.
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
  const PosixFile file(path_, PosixFile::Mode::write);
  for (const Slab& slab : {slabs.cells[0].columns[0], slabs.cells[0].columns[1], slabs.truth->pose,
                           slabs.truth->fingerprint, slabs.cells[0].fingerprint,
                           slabs.cells[0].status, slabs.cells[0].failure_step}) {
    std::byte stored{};
    file.read_at(slab.at(1), std::span(&stored, 1));
    const std::byte changed = stored ^ std::byte{2};  // of the status: complete becomes spared
    file.write_at(slab.at(1), std::span(&changed, 1));
    EXPECT_FALSE(is_whole(0, 1)) << slab.offset;
    EXPECT_TRUE(is_whole(0, 2)) << slab.offset;
    file.write_at(slab.at(1), std::span(&stored, 1));
  }
  EXPECT_TRUE(is_whole(0, 1));
}

TEST_F(RecordedResult, DamageIsFoundWithoutATruthToo) {
  write_result(folder_ / "a.h5", part_of_plan(plan_, 0, 2));
  write_result(folder_ / "b.h5", part_of_plan(plan_, 2, 3));
  {
    const PosixFile file(folder_ / "a.h5", PosixFile::Mode::write);
    const auto slabs = find_slabs(folder_ / "a.h5", describe(part_of_plan(plan_, 0, 2), {}));
    const std::byte wrong{1};
    file.write_at(slabs.cells[0].columns[0].at(1), std::span(&wrong, 1));
  }
  const std::string said = message<StudyError>([&] {
    merge_results(folder_ / "merged.h5", {folder_ / "a.h5", folder_ / "b.h5"}, Existing::refuse);
  });
  EXPECT_THAT(said, HasSubstr("run 1 is damaged"));
}

}  // namespace
}  // namespace montecarta::engine
