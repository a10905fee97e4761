// SPDX-License-Identifier: BSD-3-Clause
// What is said about recorded drives that are judged only in part, or by nothing.
#include "analysis/study/drive_facts.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "filters/factory.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/commands/program.hpp"

#include <array>
#include <cmath>

namespace montecarta::experiments {
namespace {

using analysis::DriveConsistencies;
using analysis::ReferenceAnalyses;
using analysis::StudyAnalysis;

const std::string kYardStudy = R"([study]
name = yard
runs = 1
[scenario]
kind = log
path = yard
max_range = 100
[belief]
vehicle = differential_drive
sigma_speed = 0.02
sigma_yaw_rate_deg = 0.5
sigma_range = 0.1
sigma_bearing_deg = 1
)";

/// What is said of every drive of the robot: 0.3 m/s for 60 s.
const std::string kOdometry = "The odometry is of 60 s and 18 m.";

/// A robot on a circle of 1.5 m, for 60 s. Its odometry is exact, with a row every 0.1 s; a
/// reference with a fix a second is within the errors that it states.
class Yard : public Program {
 protected:
  Yard() {
    std::filesystem::create_directory(folder_ / "yard");
    write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    std::string odometry = "time_s,speed_mps,yaw_rate_radps\n";
    for (int k = 0; k <= 600; ++k) odometry += std::to_string(0.1 * k) + ",0.3,0.2\n";
    write("yard/odometry.csv", odometry);
    write_reference(0.03);
    write("yard/detections.csv", scans_each(0.5, 60.0));
    study("cell = dead_reckoning\n");
  }

  /// Fixes whose position and heading err by turns by -`error`, 0 and `error` [m, rad].
  void write_reference(double error, double heading_error = 0.01) const {
    std::string text = "time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad\n";
    for (int t = 1; t <= 60; ++t) {
      const double heading = 0.2 * t, sign = t % 3 - 1;
      for (const double number : {1.0 * t, 1.5 * std::sin(heading) + sign * error,
                                  1.5 - 1.5 * std::cos(heading), heading + sign * heading_error}) {
        text += std::to_string(number) + ",";
      }
      text += "0.02,0.02,0.02\n";
    }
    write("yard/reference.csv", text);
  }
  /// Scans with one landmark, at regular times [s] up to `end`.
  static std::string scans_each(double period, double end) {
    std::string text = "time_s,range_m,bearing_rad,identity\n";
    for (int k = 1; k * period <= end; ++k) {
      const double heading = 0.2 * k * period;
      const double x = 5.0 - 1.5 * std::sin(heading), y = 1.5 * std::cos(heading) - 1.5;
      text += std::to_string(k * period) + "," + std::to_string(std::hypot(x, y)) + "," +
              std::to_string(std::remainder(std::atan2(y, x) - heading, kTwoPi)) + ",0\n";
    }
    return text;
  }
  void study(const std::string& cells) const {
    write("yard.ini", kYardStudy + "[cells]\n" + cells);
  }

  /// The analysis of the study with more words of `run`.
  StudyAnalysis analysed(const std::vector<std::string>& more = {}) const {
    const Called called =
        call_with({"run", "yard.ini", "-o", "out.h5", "--quiet", "--force"}, more);
    EXPECT_EQ(called.code, 0) << called.err;
    return analysis::analyze(ResultFile(folder_ / "out.h5"));
  }
  static analysis::ReferenceScores scores_of(const StudyAnalysis& study, std::size_t cell = 0) {
    return study.cells.at(cell).get<ReferenceAnalyses>().at(0).runs.at(0);
  }
};

/// Three surveyed landmarks, and a start that is half a metre off.
class SurveyedYard : public Yard {
 protected:
  SurveyedYard() {
    write("yard/landmarks.csv", "x_m,y_m\n5,0\n-4,3\n1,-5\n");
    write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n0,0.4,-0.3,0\n");
    write_scans(true);
    study(
        "cell = ekf_slam\ncell = riekf_slam\ncell = ukf_slam\n"
        "cell = fastslam1 particles=500\ncell = fastslam2 particles=100\n");
  }
  void write_scans(bool has_identities) const {
    constexpr std::array<std::array<double, 2>, 3> kPlaces = {{{5, 0}, {-4, 3}, {1, -5}}};
    std::string text =
        has_identities ? "time_s,range_m,bearing_rad,identity\n" : "time_s,range_m,bearing_rad\n";
    for (int k = 1; k <= 120; ++k) {
      const double heading = 0.1 * k;
      for (std::size_t l = 0; l < kPlaces.size(); ++l) {
        const double x = kPlaces[l][0] - 1.5 * std::sin(heading);
        const double y = kPlaces[l][1] - 1.5 + 1.5 * std::cos(heading);
        text += std::to_string(0.5 * k) + "," + std::to_string(std::hypot(x, y)) + "," +
                std::to_string(std::remainder(std::atan2(y, x) - heading, kTwoPi));
        text += has_identities ? "," + std::to_string(l) + "\n" : "\n";
      }
    }
    write("yard/detections.csv", text);
  }
  static std::vector<std::string> known(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"--set", "belief.map=known", "--set",
                                   "belief.start_sigma_m=0.5"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(SurveyedYard, IsWhereFiltersFindTheVehicleThatAreGivenTheMap) {
  const StudyAnalysis given = analysed(known());
  const StudyAnalysis built = analysed();
  for (std::size_t c = 0; c < given.cells.size(); ++c) {
    SCOPED_TRACE(given.cells[c].label);
    EXPECT_LT(scores_of(given, c).rms, 0.1);
    EXPECT_GT(scores_of(built, c).rms, 0.4) << "the map that it builds begins at a wrong start";
  }
}

TEST_F(SurveyedYard, NeedsNoIdentities) {
  write_scans(false);
  const StudyAnalysis given = analysed(known());
  for (std::size_t c = 0; c < given.cells.size(); ++c)
    EXPECT_LT(scores_of(given, c).rms, 0.1) << given.cells[c].label;
}

TEST_F(SurveyedYard, MayHaveBeenSurveyedRoughly) {
  write("yard/landmarks.csv", "x_m,y_m\n5.2,0.1\n-4.1,3.2\n0.9,-5.2\n");
  const StudyAnalysis sure = analysed(known()),
                      rough = analysed(known({"--set", "belief.map_sigma_m=0.2"}));
  EXPECT_LT(scores_of(rough).rms, 0.3);
  const auto ratio = [](const StudyAnalysis& study) {
    return study.cells[0].get<DriveConsistencies>().at(0).mean.leads().mean;
  };
  EXPECT_LT(ratio(rough), 0.5 * ratio(sure)) << "its covariance holds the errors of the survey";
}

TEST_F(SurveyedYard, IsRefusedWithoutItsSurvey) {
  std::filesystem::remove(folder_ / "yard/landmarks.csv");
  const Called called = call_with({"run", "yard.ini", "-o", "out.h5", "--quiet"}, known());
  EXPECT_NE(called.code, 0);
  EXPECT_THAT(called.err, HasSubstr("this drive has no landmarks.csv"));
}

// Half a turn lies between scans: a straight line between them is no estimate of the filter.
TEST_F(Yard, NoNumberCountsWhatLiesInAGapBetweenScans) {
  write("yard/detections.csv", scans_each(0.5, 2.0) + "18,3,0,0\n36,3,0,0\n60,3,0,0\n");
  const std::vector<std::string> by_scan = {"--set", "record.rate=scan"};
  const std::vector<std::string> by_control = {"--set", "record.rate=control"};
  const StudyAnalysis scans = analysed(by_scan), steps = analysed(by_control);
  for (const StudyAnalysis& study : {scans, steps}) {
    EXPECT_LT(scores_of(study).rms, 0.04);
    EXPECT_LT(scores_of(study).heading_rmse, 0.02);
  }
  EXPECT_EQ(scans.references[0].fixes, 5U) << "at 1, 2, 18, 36 and 60 s";
  EXPECT_EQ(scans.references[0].in_gaps, 55U);
  EXPECT_EQ(steps.references[0].fixes, 60U);
  EXPECT_EQ(scans.cells[0].get<DriveConsistencies>()[0].mean.fixes, 5U);
  EXPECT_EQ(steps.cells[0].get<DriveConsistencies>()[0].mean.fixes, 60U);
  EXPECT_EQ(scans.references[0].times.size(), 5U);
  EXPECT_THAT(drive_facts(scans), testing::Contains(testing::AllOf(
                                      HasSubstr("55 of 60 fixes of reference are left out"),
                                      HasSubstr("record.rate = control"))));
  EXPECT_THAT(drive_facts(steps), testing::ElementsAre(kOdometry));
  const std::string shown = call_with({"run", "yard.ini", "-o", "o.h5"}, by_scan).out;
  const std::size_t fact = shown.find("55 of 60 fixes"), verdict = shown.find("cannot tell");
  EXPECT_LT(fact, verdict) << "before the verdict\n" << shown;
  ASSERT_EQ(call({"report", "o.h5", "-o", "page"}).code, 0);
  EXPECT_THAT(text_of("page/index.html"), HasSubstr("55 of 60 fixes of reference"));
}

TEST_F(Yard, CountsFixesBeforeTheStartAndAfterTheLastPose) {
  write("yard/detections.csv", scans_each(0.5, 40.0));
  const StudyAnalysis scans = analysed({"--set", "record.rate=scan"});
  EXPECT_EQ(scans.references[0].fixes, 40U);
  EXPECT_EQ(scans.references[0].outside, 20U);
  EXPECT_THAT(drive_facts(scans), testing::Contains(testing::AllOf(
                                      HasSubstr("20 of 60 fixes of reference are left out"),
                                      HasSubstr("record.rate = control"))));
  EXPECT_THAT(drive_facts(analysed({"--set", "record.rate=control"})),
              testing::ElementsAre(kOdometry));
  write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n0.2,0,0,0\n");
  std::string text = text_of("yard/reference.csv");
  write("yard/reference.csv", text.insert(text.find('\n') + 1, "0.1,0,0,0,0.1,0.1,0.1\n"));
  EXPECT_THAT(drive_facts(analysed({"--set", "record.rate=control"})),
              testing::Contains(HasSubstr("1 of 61 fixes of reference are left out")));
}

TEST_F(Yard, SaysThatNoFixIsOfTheTimeOfTheDrive) {
  write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n1e9,0,0,0\n");
  write("yard/odometry.csv", "time_s,speed_mps,yaw_rate_radps\n1e9,0.3,0.2\n1000000010,0.3,0.2\n");
  write("yard/detections.csv", "time_s,range_m,bearing_rad,identity\n1000000002,3,0,0\n");
  EXPECT_THAT(drive_facts(analysed()),
              testing::Contains(testing::AllOf(HasSubstr("No fix of reference is judged: all 60"),
                                               HasSubstr("one clock"))));
}

TEST_F(Yard, SaysHowLongTheOdometryHasGaps) {
  std::string rows = "time_s,speed_mps,yaw_rate_radps\n0,0.3,0.2\n12,0,0.1\n";
  write("yard/odometry.csv", rows + "16,0,0\n60,0.3,0.2\n");
  EXPECT_THAT(drive_facts(analysed())[0], HasSubstr(" m, with gaps of up to 12 s."))
      << "from 16 s to 60 s the vehicle stands";
  write("yard/odometry.csv", rows + "16,0,0.1\n60,0.3,0.2\n");
  EXPECT_THAT(drive_facts(analysed())[0], HasSubstr(" m, with gaps of up to 44 s."));
}

TEST_F(SurveyedYard, SaysThatNoDetectionWasComparedWithTheMap) {
  study("cell = ekf_slam\ncell = fastslam2 particles=10\n");
  const auto compared =
      HasSubstr("compared with a landmark of the map by ekf_slam, fastslam2_m10: ");
  EXPECT_THAT(drive_facts(analysed(known())),
              testing::Not(testing::Contains(HasSubstr("No detection"))));
  EXPECT_THAT(drive_facts(analysed(known({"--set", "scenario.max_range=1"}))),
              testing::Contains(compared));
  write("yard/detections.csv", "time_s,range_m,bearing_rad,identity\n1,5,0,0\n2,5,1,1\n");
  EXPECT_THAT(drive_facts(analysed()), testing::Contains(compared)) << "each was seen once";
}

TEST_F(Yard, SaysWhatHappenedBeforeEveryVerdict) {
  study("cell = ekf_slam\ncell = dead_reckoning\n");
  analysed({"--set", "scenario.max_range=1"});
  ASSERT_EQ(call({"report", "out.h5", "-o", "page"}).code, 0);
  for (const std::string& shown : {call({"analyze", "out.h5"}).out,
                                   call({"compare", "out.h5", "--baseline", "dead_reckoning"}).out,
                                   text_of("page/summary.md")}) {
    const std::size_t fact = shown.find("No landmark was initialised by ekf");
    EXPECT_NE(fact, std::string::npos) << shown;
    EXPECT_LT(fact, shown.find("cannot tell")) << shown;
    EXPECT_EQ(shown.find("No landmark was initialised", fact + 1), std::string::npos) << "once";
  }
}

TEST_F(Yard, SaysThatNoLandmarkWasInitialised) {
  study("cell = ekf_slam\ncell = riekf_slam\ncell = dead_reckoning\n");
  EXPECT_THAT(drive_facts(analysed()), testing::ElementsAre(kOdometry));
  const StudyAnalysis without = analysed({"--set", "scenario.max_range=1"});
  EXPECT_THAT(drive_facts(without),
              testing::ElementsAre(
                  kOdometry, HasSubstr("No landmark was initialised by ekf_slam, riekf_slam: ")));
}

TEST_F(Yard, SaysThatTheHeadingsOfTheReferenceAreThoseOfTheOdometry) {
  write_reference(0.03, 0.0);
  EXPECT_THAT(drive_facts(analysed()),
              testing::ElementsAre(kOdometry,
                                   HasSubstr("headings of reference are those of the odometry")));
}

TEST_F(Yard, SaysWhichRatioIsLeftWithoutGrossOutliers) {
  std::string text = text_of("yard/reference.csv");
  text.replace(text.find("\n7.000000,") + 10, 1, "9");  // from 1.4 to 9.4 m
  write("yard/reference.csv", text);
  const auto facts = drive_facts(analysed());
  ASSERT_EQ(facts.size(), 2U);
  EXPECT_THAT(facts[1], testing::AllOf(HasSubstr("1 of 60 fixes"), HasSubstr("without them")));
}

TEST_F(Yard, EqualResultsTie) {
  study("cell = ekf_slam\ncell = dead_reckoning\n");
  analysed({"--set", "scenario.max_range=1"});
  EXPECT_THAT(call({"analyze", "out.h5", "--table", "baseline"}).out,
              HasSubstr("equal in every run"));
}

TEST_F(Yard, WithoutAReferenceIsJudgedByItsInnovations) {
  std::filesystem::remove(folder_ / "yard/reference.csv");
  study("cell = ekf_slam\n");
  EXPECT_EQ(call({"check", "yard.ini"}).code, 0);
  const StudyAnalysis found = analysed();
  EXPECT_TRUE(found.references.empty());
  EXPECT_NE(found.cells[0].find<analysis::Innovations>(), nullptr);
  EXPECT_THAT(call({"analyze", "out.h5"}).out, HasSubstr("ekf_slam, innovations: "));
}

// Twenty equal runs are computed once for each thread, and say no more than one.
TEST_F(Yard, RunsThatCannotDifferAreStoredForEachAndCountOnce) {
  study("cell = ekf_slam\ncell = fastslam2 particles=10\n");
  const StudyAnalysis one = analysed(), many = analysed({"--set", "study.runs=20"});
  const ResultFile file(folder_ / "out.h5");
  std::vector<double> first(3 * file.times().size()), last(first);
  for (const std::size_t cell : {0U, 1U}) {
    EXPECT_THAT(file.status(file.cells()[cell]), testing::Each(RunStatus::complete));
    file.read(file.cells()[cell], "pose_mean", 0, std::span(first));
    file.read(file.cells()[cell], "pose_mean", 19, std::span(last));
    EXPECT_EQ(first == last, cell == 0);
  }
  const auto nis = [](const StudyAnalysis& study, std::size_t cell) {
    const analysis::Innovations& found = study.cells[cell].get<analysis::Innovations>();
    return std::tuple(found.ratio, found.autocorrelation, found.white_bound);
  };
  EXPECT_EQ(nis(many, 0), nis(one, 0));
  EXPECT_EQ(nis(many, 1), nis(one, 1)) << "runs on one drive have the same measurements";
  std::filesystem::rename(folder_ / "out.h5", folder_ / "once.h5");
  analysed({"--set", "study.runs=20", "--threads", "2"});
  EXPECT_EQ(engine::difference(ResultFile(folder_ / "out.h5"), ResultFile(folder_ / "once.h5")),
            "");
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "40", "--data", "yard"}).code, 0);
}

// Recomputed one by one, the runs are those that were stored without being computed.
TEST_F(Yard, EveryFilterWithoutParticlesGivesTheSameInEveryRun) {
  std::string cells;
  std::size_t filters = 0;
  for (const FilterKind& kind : filters::filter_kinds()) {
    if (kind.reports.particles || kind.name == "external") continue;
    cells += "cell = " + kind.name + "\n";
    ++filters;
  }
  ASSERT_GT(filters, 8U);
  study(cells);
  write("yard/detections.csv", scans_each(0.5, 5.0));
  EXPECT_THAT(drive_facts(analysed({"--set", "study.runs=2", "--threads", "1"})),
              testing::Not(testing::Contains(HasSubstr("No detection"))));
  const ResultFile file(folder_ / "out.h5");
  for (const StoredCell& cell : file.cells()) {
    EXPECT_THAT(file.status(cell), testing::Each(RunStatus::complete)) << cell.label;
    EXPECT_EQ(file.fingerprints(cell)[0], file.fingerprints(cell)[1]) << cell.label;
  }
  EXPECT_THAT(call({"verify", "out.h5", "--sample", "100", "--data", "yard"}).out,
              HasSubstr("runs are reproduced byte for byte"));
}

TEST_F(Yard, AsRobotsLogItIsRefusedWithTheScriptThatRepairsIt) {
  const std::string script = "repair_log.py FOLDER -o NEW_FOLDER";
  write("yard/detections.csv",
        "time_s,range_m,bearing_rad,identity\n1,5,0.1,0\n1,5.02,0.11,0\n2,4,0.1,0\n");
  expect_refused({"check", "yard.ini"}, script);
  write("yard/detections.csv", scans_each(0.5, 60.0));
  write("yard/odometry.csv", "time_s,speed_mps,yaw_rate_radps\n0,1,0\n1,1,0\n1,1.1,0\n60,1,0\n");
  expect_refused({"check", "yard.ini"}, script);
  write("yard/odometry.csv", "time_s,speed_mps,yaw_rate_radps\n0,1,0\n1,1,0\n0.9,1,0\n60,1,0\n");
  expect_refused({"check", "yard.ini"}, script);
}

}  // namespace
}  // namespace montecarta::experiments
