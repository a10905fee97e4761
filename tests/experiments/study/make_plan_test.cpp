// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/make_plan.hpp"

#include "analysis/run/study_facts.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/errors.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/enough_runs.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/study/study.hpp"
#include "experiments/text/words.hpp"
#include "filters/factory.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace montecarta::experiments {
namespace {

std::string plan_complaint(const std::string& text) {
  return engine::complaint_of([&] { make_plan(parsed(text)); });
}

TEST(Plan, CarriesTheStudy) {
  const StudyPlan plan = make_plan(parsed(kGoodStudy), RunRange{5, 9});
  EXPECT_EQ(plan.name, "trial");
  EXPECT_EQ(plan.runs, 20U);
  EXPECT_EQ(plan.runs_here(), 4U);
  ASSERT_EQ(plan.cells.size(), 1U);
  EXPECT_EQ(plan.cells[0].landmarks, 35U);
  EXPECT_NE(plan.cells[0].make_filter(), nullptr);
  EXPECT_TRUE(plan.columns.covariance);
  EXPECT_FALSE(plan.columns.map);
  EXPECT_EQ(plan.drives->itinerary().landmarks.size(), 35U);
}

TEST(Plan, OfFullRunsIsAnotherStudyAndOfNoneTheSame) {
  const auto with_runs = [](const std::string& runs) {
    return make_plan(parsed(with("[cells]", "[record]\nfull_runs = " + runs + "\n[cells]")));
  };
  const StudyPlan plain = make_plan(parsed(kGoodStudy)), none = with_runs("0"),
                  two = with_runs("2");
  EXPECT_EQ(plain.columns.full_runs, 0U);
  EXPECT_EQ(none.resolved_text, plain.resolved_text);
  EXPECT_EQ(two.columns.full_runs, 2U);
  EXPECT_EQ(make_plan(parsed(two.resolved_text)).resolved_text, two.resolved_text);
  EXPECT_NE(two.resolved_text, plain.resolved_text);
}

TEST(Plan, OfTheResolvedTextIsTheSame) {
  const std::string text =
      with("[cells]",
           "sigma_range = 0.3\nmax_range = 20\n[record]\ncolumns = pose\nrate = scan\n[cells]");
  const StudyPlan plan = make_plan(parsed(text));
  const StudyPlan again = make_plan(parsed(plan.resolved_text));
  EXPECT_EQ(again.resolved_text, plan.resolved_text);
  EXPECT_EQ(again.scenario, plan.scenario);
  EXPECT_EQ(again.cells[0].label, plan.cells[0].label);
  EXPECT_EQ(again.cells[0].long_name, plan.cells[0].long_name);
  EXPECT_TRUE(again.columns.scans_only);
  Drive drive;
  Drive drive_again;
  plan.drives->generate(3, drive);
  again.drives->generate(3, drive_again);
  EXPECT_TRUE(std::ranges::equal(
      drive.detections, drive_again.detections,
      [](const Detection& a, const Detection& b) { return a[0] == b[0] && a[1] == b[1]; }));
}

TEST(Plan, RefusesSettingsThatDoNotFitTogether) {
  EXPECT_THAT(plan_complaint(with("[cells]", "scan_rate = 7\n[cells]")), HasSubstr("trial.ini:6"));
  EXPECT_THAT(plan_complaint(with("[cells]", "scan_rate = 80\n[cells]")), HasSubstr("scan_rate"));
  EXPECT_THAT(plan_complaint(with("[cells]", "[association]\nnew_gate_sigma = 1\n[cells]")),
              HasSubstr("new_gate_sigma is below gate_sigma"));
  EXPECT_THAT(plan_complaint(with("[cells]", "waypoint_radius = 0.001\n[cells]")),
              HasSubstr("is not reached within 0.001 m"));
}

TEST(Plan, RefusesJointEstimatesThatNoCellHas) {
  const std::string record = "[record]\ncolumns = pose, joint\n[cells]";
  EXPECT_THAT(plan_complaint(with("[cells]\ncell = ekf_slam", record + "\ncell = fastslam2")),
              HasSubstr("trial.ini:7: joint (none of the cells' filters"));
  const StudyPlan plan = make_plan(parsed(with("[cells]", record) + "cell = fastslam2\n"));
  EXPECT_TRUE(plan.cells[0].reports.joint);
  EXPECT_FALSE(plan.cells[1].reports.joint);
  EXPECT_EQ(plan.columns.joint_scans, 16u);
  EXPECT_THAT(plan_complaint(with("[cells]", "[association]\nkind = nearest\n" + record) +
                             "cell = smoother\n"),
              HasSubstr("the landmarks of a map cannot be identified"));
}

TEST(Plan, KeepsTheMarginInTheText) {
  const StudyPlan plan = make_plan(parsed(with("[scenario]", "within = 1.25\n[scenario]")));
  EXPECT_EQ(study_facts_in(plan.resolved_text, 1).within, 1.25);
  EXPECT_EQ(study_facts_in(make_plan(parsed(kGoodStudy)).resolved_text, 1).within, kUsualMargin);
  EXPECT_EQ(kUsualMarginText, to_text(kUsualMargin));
}

TEST(Plan, HasAMixtureWhereTheEstimatesHaveOne) {
  std::string cells = "cell = fastslam1\ncell = marginal\n";
  for (const char* filter : {"fastslam2", "ufastslam", "srcd", "srcd_aided", "srcd_pf"}) {
    cells += "cell = " + std::string(filter) + "\ncell = " + filter + " weights=ratio\n";
  }
  for (const char* mode : {"unbiased", "as_printed", "prior", "shared"}) {
    cells += "cell = de_srcd mode=" + std::string(mode) + "\n";
  }
  const StudyPlan plan = make_plan(parsed(kGoodStudy + cells));
  const std::vector<Detection> scan{{5.0, 0.3, 0}, {7.0, -0.4, 1}};
  std::size_t mixtures = 0;
  for (const Cell& cell : plan.cells) {
    const auto filter = cell.make_filter();
    filter->start({});
    for (std::uint32_t step = 0; step < 4; ++step) {
      const StepContext context(1, 0, step, Parallel::serial());
      filter->predict(context, {1.0, 0.1}, 0.1);
      EXPECT_EQ(filter->estimate().mixture.has_value(), cell.reports.mixture) << cell.long_name;
      filter->update(context, scan);
      EXPECT_EQ(filter->estimate().mixture.has_value(), cell.reports.mixture) << cell.long_name;
    }
    mixtures += cell.reports.mixture ? 1 : 0;
  }
  EXPECT_EQ(mixtures, 7U);
}

TEST(OwnColumns, AreInTheDescriptionOfTheFormat) {
  std::ifstream file(std::filesystem::path(MONTECARTA_SOURCE_DIR) / "analysis/FORMAT.md");
  const std::string format((std::istreambuf_iterator<char>(file)), {});
  std::size_t columns = 0;
  for (const FilterKind& kind : filter_kinds()) {
    for (const OwnColumn& own : kind.reports.own_columns) {
      const std::string row = "`" + own.name + "` | f64 {run, scan} | " + own.units + " |";
      EXPECT_THAT(format, HasSubstr(row)) << "of " << kind.name;
      ++columns;
    }
  }
  EXPECT_GT(columns, 0U);
}

TEST(Plan, CanScanAsThePublicSimulatorDoes) {
  const StudyPlan plan =
      make_plan(parsed(with("[cells]", "scan_rate = 4.444444444444445\n[cells]")));
  EXPECT_EQ(plan.drives->itinerary().scan_step[0], 8U) << "every ninth step (EQUATIONS 1)";
}

TEST(RunRange, IsHalfOpen) {
  EXPECT_EQ(parse_run_range("3:7", 20).first, 3U);
  EXPECT_EQ(parse_run_range("3:7", 20).last, 7U);
  EXPECT_EQ(parse_run_range(":7", 20).first, 0U);
  EXPECT_EQ(parse_run_range("3:", 20).last, 20U);
  for (const char* bad : {"", "3", "7:3", "3:3", "0:21", "-1:4", "1:2:3", "a:b"}) {
    EXPECT_THROW(parse_run_range(bad, 20), StudyError) << bad;
  }
}

TEST(Shards, FollowEachOtherWithoutGaps) {
  for (const std::uint64_t runs : {4U, 7U, 40U, 10'000'000U}) {
    std::uint64_t next = 0;
    for (int i = 0; i < 4; ++i) {
      const RunRange shard = parse_shard(std::to_string(i) + "/4", runs);
      EXPECT_EQ(shard.first, next);
      EXPECT_GT(shard.last, shard.first);
      next = shard.last;
    }
    EXPECT_EQ(next, runs);
  }
  for (const char* bad : {"", "1", "4/4", "0/0", "0/8", "-1/4", "a/b", "0/4/1"}) {
    EXPECT_THROW(parse_shard(bad, 7), StudyError) << bad;
  }
}

std::string study_until(const std::string& rule) {
  return with("runs = 20", "runs = 20\nuntil = " + rule);
}

TEST(StoppingRule, IsPartOfTheStudyInOneSpelling) {
  const Study study = parsed(study_until("position_rmse<2e-2"));
  ASSERT_TRUE(study.until);
  EXPECT_EQ(text_of(*study.until), "position_rmse < 0.02");
  EXPECT_EQ(resolved_settings(study).at("study.until"), "position_rmse < 0.02");
  EXPECT_TRUE(make_plan(study).is_enough);
  EXPECT_THAT(engine::complaint_of([&] {
                make_plan(study, RunRange{0, 10});
              }),
              HasSubstr("--set study.until="))
      << "all runs are needed";
  EXPECT_TRUE(make_plan(parsed(study_until("verdict")), RunRange{0, 10}).is_enough)
      << "a part can refuse";
  const Study again = parse_study(resolved_text(study), "again.ini", ".", known_filters());
  EXPECT_EQ(resolved_text(again), resolved_text(study));
}

// Studies without it have the text, and so the SHA-256, that they always had.
TEST(StoppingRule, IsNotSaidWhereItIsNotAsked) {
  const Study study = parsed(kGoodStudy);
  EXPECT_FALSE(study.until);
  EXPECT_FALSE(make_plan(study).is_enough);
  EXPECT_FALSE(resolved_settings(study).contains("study.until"));
  EXPECT_FALSE(parsed(study_until("")).until);
}

TEST(StoppingRule, RefusesWhatItCannotDecide) {
  EXPECT_THAT(plan_complaint(study_until("postion_rmse < 1")), HasSubstr("trial.ini:4"));
  EXPECT_THAT(plan_complaint(study_until("cpu_seconds < 1")), HasSubstr("processor time"));
  for (const char* rule :
       {"position_rmse", "position_rmse < ", "position_rmse < -1", "position_rmse < 0",
        "position_rmse < 1 < 2", "< 3", "position_rmse > 1"}) {
    EXPECT_THAT(plan_complaint(study_until(rule)), HasSubstr("until = ")) << rule;
  }
}

TEST(StoppingRule, MayBeTheVerdict) {
  const Study study = parsed(study_until(" verdict "));
  ASSERT_TRUE(study.until);
  EXPECT_EQ(text_of(*study.until), "verdict");
  EXPECT_EQ(resolved_settings(study).at("study.until"), "verdict");
  EXPECT_TRUE(make_plan(study).is_enough);
  EXPECT_THAT(in_words(*study.until, 1000), HasSubstr("widened for up to 6 interim analyses"));
  const Study poses = parsed(study_until("verdict"), {"record.columns=pose"});
  EXPECT_THAT(engine::complaint_of([&] { make_plan(poses); }), HasSubstr("trial.ini:4"));
}

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

/// A folder with a small drive in `drive` that has no identities.
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
    return parse_study(text, "trial.ini", folder_.path(), known_filters(), overrides);
  }
  std::string complaint(const std::vector<std::string>& overrides) const {
    return engine::complaint_of([&] { make_plan(read(kStudy, overrides), std::nullopt); });
  }
  ScratchFolder folder_;
  DriveLog log_;
};

TEST_F(RecordedStudy, ReadsItsDriveBesideTheStudyAndFillsInWhatSuitsIt) {
  const Study study = read(kStudy);
  ASSERT_EQ(study.logs.size(), 1U);
  EXPECT_EQ(study.logs[0]->odometry.size(), log_.odometry.size());
  EXPECT_EQ(study.settings.text("association", "kind"), "nearest");
  EXPECT_EQ(study.settings.text("record", "rate"), "scan");
  EXPECT_EQ(study.settings.text("scenario", "path"), "log");
  EXPECT_EQ(study.settings.text("scenario", "data_sha256").size(), 64U);
  const StudyPlan plan = make_plan(study, std::nullopt);
  EXPECT_FALSE(plan.drives->itinerary().has_truth);
  EXPECT_TRUE(plan.columns.final_map);
  const Study wide = read(kStudy, {"association.most_landmarks=77"});
  EXPECT_EQ(make_plan(wide, std::nullopt).cells[0].landmarks, 77U);
}

TEST_F(RecordedStudy, IsCalledTheSameWhereverItsDriveLies) {
  std::filesystem::create_directory(folder_ / "elsewhere");
  std::filesystem::rename(folder_ / "drive", folder_ / "elsewhere/tuesday");
  const Study elsewhere = read(kStudy, {"scenario.path=elsewhere/tuesday"});
  const std::string moved = resolved_text(elsewhere);
  std::filesystem::rename(folder_ / "elsewhere/tuesday", folder_ / "drive");
  EXPECT_EQ(moved, resolved_text(read(kStudy)));
  EXPECT_EQ(moved, resolved_text(read(moved, {"scenario.path=drive"})))
      << "the resolved text is a study of its own";
  EXPECT_FALSE(resolved_settings(elsewhere).contains("scenario.world"));
  EXPECT_FALSE(resolved_settings(elsewhere).contains("scenario.loops"));
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
  EXPECT_EQ(read(kStudy, {"scenario.path=my,drive"}).logs.size(), 1U);
}

TEST_F(RecordedStudy, RefusesAnotherDriveThanItWasMadeWith) {
  const std::string resolved = resolved_text(read(kStudy));
  std::filesystem::remove_all(folder_ / "drive");
  log_.odometry[1].control[0] += 1e-9;
  write_log_csv(log_, folder_ / "drive");
  EXPECT_THAT(engine::complaint_of([&] { read(resolved, {"scenario.path=drive"}); }),
              HasSubstr("is another one than the study was made with"));
}

TEST_F(RecordedStudy, SaysWhatDoesNotFitARecordedDrive) {
  EXPECT_THAT(complaint({}), "nothing");
  EXPECT_THAT(complaint({"scenario.loops=2"}),
              HasSubstr("scenario.loops does not apply to scenario.kind = log"));
  EXPECT_THAT(complaint({"scenario.sigma_speed=2"}), HasSubstr("give it under [belief]"));
  EXPECT_THAT(complaint({"scenario.path=nowhere"}), HasSubstr("no folder 'nowhere'"));
  EXPECT_THAT(complaint({"scenario.reference=gpz"}), HasSubstr("did you mean gps?"));
  EXPECT_THAT(complaint({"association.kind=known"}), HasSubstr("carry no identity"));
  EXPECT_THAT(complaint({"record.columns=pose, association"}), HasSubstr("carry no identity"));
  std::string endless = "scenario.path=";
  EXPECT_THAT(complaint({endless.append(300, 'x')}), HasSubstr("no folder"));
  EXPECT_THAT(complaint({"scenario.scan_delay=0.01"}), HasSubstr("before the start of the drive"));
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

TEST_F(RecordedStudy, AsksForVehicleAndNoiseAndTakesIdentitiesOfTheLog) {
  for (const char* key : {"wheelbase", "sigma_speed", "sigma_bearing_deg"}) {
    std::string text = kStudy;
    const std::size_t begin = text.find(key);
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    EXPECT_THAT(engine::complaint_of([&] { read(text); }),
                HasSubstr("belief." + std::string(key) + " is missing"));
  }
  std::filesystem::remove_all(folder_ / "drive");
  write_log_csv(full_log(), folder_ / "drive");
  EXPECT_EQ(complaint({"association.kind=known"}), "nothing");
}

}  // namespace
}  // namespace montecarta::experiments
