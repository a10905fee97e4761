// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/find_recording.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/study/study.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace montecarta::experiments {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kStudy = R"([study]
name = trial
runs = 2
[scenario]
kind = log
path = drive
[belief]
wheelbase = 2.5
sigma_speed = 0.4
sigma_steer_deg = 2
sigma_range = 0.3
sigma_bearing_deg = 1
[cells]
cell = ekf_slam
)";

/// A folder with a small drive in `drive`, whose detections nobody identified.
class RecordedStudy : public ::testing::Test {
 protected:
  RecordedStudy() {
    log_ = full_log();
    for (LoggedScan& scan : log_.scans) {
      for (Detection& detection : scan.detections) detection.identity = Detection::kUnidentified;
    }
    write_log_csv(log_, folder_ / "drive");
  }
  Study read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    return parse_study(text, "trial.ini", folder_.path(), overrides);
  }
  std::string complaint(const std::vector<std::string>& overrides) const {
    try {
      make_plan(read(kStudy, overrides), std::nullopt);
    } catch (const StudyError& error) {
      return error.what();
    }
    return "no complaint";
  }
  ScratchFolder folder_;
  DriveLog log_;
};

TEST_F(RecordedStudy, ReadsItsDriveBesideTheStudyAndFillsInWhatSuitsIt) {
  const Study study = read(kStudy);
  ASSERT_NE(study.log, nullptr);
  EXPECT_EQ(study.log->odometry.size(), log_.odometry.size());
  EXPECT_EQ(study.settings.text("association", "kind"), "nearest");
  EXPECT_EQ(study.settings.text("record", "rate"), "scan");
  EXPECT_EQ(study.settings.text("scenario", "path"), "log");
  EXPECT_EQ(study.settings.text("scenario", "data_sha256").size(), 64U);
  const StudyPlan plan = make_plan(study, std::nullopt);
  EXPECT_FALSE(plan.drives->itinerary().has_truth);
  EXPECT_TRUE(plan.columns.final_map);
}

TEST_F(RecordedStudy, IsCalledTheSameWhereverItsDriveLies) {
  std::filesystem::create_directory(folder_ / "elsewhere");
  std::filesystem::rename(folder_ / "drive", folder_ / "elsewhere/tuesday");
  const std::string moved = resolved_text(read(kStudy, {"scenario.path=elsewhere/tuesday"}));
  std::filesystem::rename(folder_ / "elsewhere/tuesday", folder_ / "drive");
  EXPECT_EQ(moved, resolved_text(read(kStudy)));
  EXPECT_EQ(moved, resolved_text(read(moved, {"scenario.path=drive"})))
      << "the resolved text is a study of its own";
  EXPECT_THAT(moved, AllOf(Not(HasSubstr("world")), Not(HasSubstr("loops"))));
}

TEST_F(RecordedStudy, FindsFoldersWithCommasInTheirNames) {
  for (const char* name : {"a", "b,c", "d, e/f"}) {
    std::filesystem::create_directories(folder_ / name);
  }
  const auto named = [&](const std::string& list) { return recordings_in(list, {folder_.path()}); };
  EXPECT_THAT(named("b,c"), testing::ElementsAre("b,c"));
  EXPECT_THAT(named("a, b,c,d, e/f"), testing::ElementsAre("a", "b,c", "d, e/f"));
  EXPECT_THAT(named("a,nowhere , b,c"), testing::ElementsAre("a", "nowhere", "b,c"));
  EXPECT_THAT(named("a,,a,"), testing::ElementsAre("a", "", "a", ""));
  EXPECT_THAT(named(""), testing::ElementsAre(""));
  std::filesystem::rename(folder_ / "drive", folder_ / "my,drive");
  EXPECT_NE(read(kStudy, {"scenario.path=my,drive"}).log, nullptr);
}

TEST_F(RecordedStudy, RefusesAnotherDriveThanItWasMadeWith) {
  const std::string resolved = resolved_text(read(kStudy));
  std::filesystem::remove_all(folder_ / "drive");
  log_.odometry[1].control[0] += 1e-9;
  write_log_csv(log_, folder_ / "drive");
  try {
    read(resolved, {"scenario.path=drive"});
    ADD_FAILURE() << "it was read";
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is another one than the study was made with"));
  }
}

TEST_F(RecordedStudy, SaysWhatDoesNotFitARecordedDrive) {
  EXPECT_THAT(complaint({}), "no complaint");
  EXPECT_THAT(complaint({"scenario.loops=2"}),
              HasSubstr("scenario.loops says nothing of a scenario of kind log (it is for "
                        "simulated): remove it"));
  EXPECT_THAT(complaint({"scenario.sigma_speed=2"}), HasSubstr("give it under [belief]"));
  EXPECT_THAT(complaint({"scenario.path=nowhere"}),
              AllOf(HasSubstr("no folder 'nowhere'"), HasSubstr("MONTECARTA_DATA")));
  EXPECT_THAT(complaint({"scenario.reference=gpz"}), HasSubstr("did you mean gps?"));
  EXPECT_THAT(complaint({"association.kind=known"}), HasSubstr("carry no identity"));
  EXPECT_THAT(complaint({"record.columns=pose, association"}), HasSubstr("carry no identity"));
  std::string endless = "scenario.path=";
  EXPECT_THAT(complaint({endless.append(300, 'x')}), HasSubstr("no folder"));
  EXPECT_THAT(complaint({"scenario.scan_delay=0.01"}),
              AllOf(HasSubstr("before the start of the drive"), HasSubstr("at most 0.009")));
  EXPECT_THAT(complaint({"belief.vehicle=rear_wheel", "belief.wheel_left=25"}),
              HasSubstr("odometry record 2 steers by"));
}

TEST_F(RecordedStudy, JudgesByTheReferenceThatItNames) {
  const Study study = read(kStudy, {"scenario.reference=gps"});
  const StudyPlan plan = make_plan(study, std::nullopt);
  ASSERT_EQ(plan.drives->itinerary().references.size(), 1U);
  EXPECT_EQ(plan.drives->itinerary().references[0].name, "gps");
  EXPECT_EQ(study.settings.text("scenario", "data_sha256"),
            read(kStudy).settings.text("scenario", "data_sha256"))
      << "the drive is the same";
}

TEST_F(RecordedStudy, AsksForTheVehicleAndNoiseOfADriveOfTheUsersOwn) {
  for (const char* key : {"wheelbase", "sigma_speed", "sigma_bearing_deg"}) {
    std::string text = kStudy;
    const std::size_t begin = text.find(key);
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    try {
      read(text);
      ADD_FAILURE() << key;
    } catch (const StudyError& error) {
      EXPECT_THAT(error.what(), HasSubstr("belief." + std::string(key) + " is missing"));
    }
  }
}

TEST_F(RecordedStudy, HasRoomForTheWholeMap) {
  EXPECT_EQ(
      make_plan(read(kStudy, {"association.most_landmarks=77"}), std::nullopt).cells[0].landmarks,
      77U);
}

TEST_F(RecordedStudy, TakesKnownIdentitiesWhereTheLogHasThem) {
  std::filesystem::remove_all(folder_ / "drive");
  write_log_csv(full_log(), folder_ / "drive");
  EXPECT_EQ(complaint({"association.kind=known"}), "no complaint");
}

}  // namespace
}  // namespace montecarta::experiments
