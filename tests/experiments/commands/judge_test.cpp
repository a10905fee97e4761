// SPDX-License-Identifier: BSD-3-Clause
// Estimates of another program, end to end.
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/result_file.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

const std::string kHeader =
    "time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_0,cov_1_1,cov_1_2,cov_2_0,cov_2_1,"
    "cov_2_2\n";

std::string row_of(std::span<const double> numbers) {
  std::string row;
  for (const double number : numbers) append_part(row, to_text(number), ",");
  return row + "\n";
}

class Judge : public BlinkProgram {
 protected:
  /// Runs the study of two filters and writes their estimates, as another program would, beside the
  /// drives that `export` writes: drives/CELL/run_000N.csv.
  void write_own_estimates() const {
    ASSERT_EQ(call({"run", "blink.ini", "-o", "own.h5", "--quiet"}).code, 0);
    ASSERT_EQ(call({"export", "blink.ini", "-o", "drives"}).code, 0);
    const ResultFile file(folder_ / "own.h5");
    for (const StoredCell& cell : file.cells()) {
      const std::string suffix = cell.has("pose_mean_mixture") ? "_mixture" : "";
      std::filesystem::create_directories(folder_ / "drives" / cell.label);
      std::vector<double> mean(3 * file.times().size()), P(9 * file.times().size());
      for (std::size_t run = 0; run < file.runs().size(); ++run) {
        file.read(cell, "pose_mean" + suffix, run, std::span(mean));
        file.read(cell, "pose_covariance" + suffix, run, std::span(P));
        std::string text = kHeader;
        for (const std::size_t k : file.scan_rows()) {
          std::vector<double> row = {file.times()[k]};
          row.insert(row.end(), mean.begin() + 3 * k, mean.begin() + 3 * (k + 1));
          row.insert(row.end(), P.begin() + 9 * k, P.begin() + 9 * (k + 1));
          text += row_of(row);
        }
        write("drives/" + cell.label + "/run_000" + std::to_string(run) + ".csv", text);
      }
    }
  }
  std::vector<std::string> estimates(const std::string& cell) const {
    std::vector<std::string> names;
    for (int run = 0; run < 3; ++run)
      names.push_back("drives/" + cell + "/run_000" + std::to_string(run) + ".csv");
    return names;
  }
  Called judge(std::vector<std::string> words, const std::vector<std::string>& more) const {
    words.insert(words.begin(), "judge");
    return call_with(words, more);
  }
  analysis::StudyAnalysis analyzed(const std::string& name) const {
    return analysis::analyze(ResultFile(folder_ / name));
  }
  /// Two runs of a pose with two rows each, the first of which is given.
  Called judged(const std::string& first, const std::string& error = "world") const {
    write("e_0.csv", first);
    write("e_1.csv", kHeader + "1,0.1,0,0,1,0,0,0,1,0,0,0,1\n2,0,0.1,0,1,0,0,0,1,0,0,0,1\n");
    write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n2,0,0,0\n");
    return judge({"e_0.csv", "e_1.csv"},
                 {"--truth", "truth.csv", "--error", error, "-o", "mine.h5", "--force"});
  }
};

// Law: the verdict on our own filter's estimates is that on the filter.
TEST_F(Judge, OwnEstimatesHaveTheVerdictOfTheirFilterAndEveryCommandReadsThem) {
  write_own_estimates();
  std::vector<std::string> files = estimates("ekf_slam");
  const Called called = judge(files, {"--truth", "drives", "--error", "world", "-o", "ekf.h5"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, AllOf(HasSubstr("ekf_slam"), HasSubstr("Imported estimates")));
  const auto own = analyzed("own.h5").cells[0], mine = analyzed("ekf.h5").cells[0];
  ASSERT_EQ(mine.nees.size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(own.nees[b].series.lower_rank, 0U);
    const double expected = own.nees[b].mean;
    EXPECT_NEAR(mine.nees[b].mean, expected, 1e-12 * expected);
  }
  EXPECT_EQ(mine.verdict.answer, own.verdict.answer);
  EXPECT_NEAR(mine.verdict.ratio_estimate(), own.verdict.ratio_estimate(), 1e-9);
  EXPECT_DOUBLE_EQ(mine.over_runs("position_rmse").mean, own.over_runs("position_rmse").mean);
  for (const std::string& name : estimates("fastslam2_m10")) files.push_back(name);
  ASSERT_EQ(judge(files, {"--truth", "drives", "--error", "body", "-o", "mine.h5"}).code, 0);
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"analyze", "mine.h5", "--all", "--csv", "tables", "-o", "all.h5"},
           {"report", "mine.h5", "-o", "page"},
           {"compare", "mine.h5", "--baseline", "ekf_slam"},
           {"info", "mine.h5"}}) {
    const Called read = call(words);
    EXPECT_EQ(read.code, 0) << words[0] << read.err;
    EXPECT_THAT(read.out + read.err, Not(HasSubstr("damaged"))) << words[0];
  }
  EXPECT_THAT(text_of("page/index.html"), HasSubstr("Imported estimates of another program"));
  EXPECT_THAT(call({"verify", "mine.h5"}).err, HasSubstr("another program computed"));
  EXPECT_THAT(call({"replay", "mine.h5", "--cell", "ekf_slam", "--run", "0", "-o", "r.h5"}).err,
              HasSubstr("another program computed"));
}

// A run that ends before the others, or has no estimates at all, is a failure and stays one.
TEST_F(Judge, RunsThatEndEarlyHaveFailed) {
  const std::string first = "1,0.1,0,0,1,0,0,0,1,0,0,0,1\n";
  ASSERT_EQ(judged(kHeader + first).code, 0);
  const ResultFile file(folder_ / "mine.h5");
  EXPECT_EQ(file.times().size(), 2U);
  const auto cell = analyzed("mine.h5").cells[0];
  EXPECT_EQ(cell.complete, 1U);
  ASSERT_EQ(cell.failures.size(), 1U);
  EXPECT_EQ(cell.failures[0].step, 1U);
  EXPECT_EQ(cell.failures[0].reason, "estimates end at 1 s");
  EXPECT_EQ(judged(kHeader).code, 0);
  EXPECT_EQ(analyzed("mine.h5").cells[0].failures[0].reason, "no estimates");
  write("none_0.csv", kHeader);
  EXPECT_THAT(judge({"none_0.csv"}, {"--truth", "truth.csv", "--error", "world", "-o", "x.h5"}).err,
              HasSubstr("none_0.csv: no rows behind the header, nor in any other file"));
}

TEST_F(Judge, CovariancesThatAreNoneAreCountedAndLeftOut) {
  const std::string good = "1,1,0,0,1,0,0,0,1,0,0,0,1\n";
  for (const auto& [bad, reason] :
       {std::pair("2,1,0,0,-1,0,0,0,1,0,0,0,1\n", "has a negative variance"),
        std::pair("2,1,0,0,1,2,0,2,1,0,0,0,1\n", "is not positive semidefinite"),
        std::pair("2,1,0,0,1,0.5,0,0,1,0,0,0,1\n", "is not symmetric")}) {
    const Called called = judged(kHeader + good + bad);
    ASSERT_EQ(called.code, 0) << called.err;
    EXPECT_THAT(called.out, HasSubstr("1 of 4 samples (25.0 %)")) << bad;
    EXPECT_THAT(called.err, HasSubstr(std::string("e: the covariance ") + reason +
                                      " in 1 row, the first in e_0.csv:3"));
    const analysis::CellAnalysis cell = analyzed("mine.h5").cells[0];
    EXPECT_EQ(cell.nees[0].series.unusable, 1U);
    EXPECT_NEAR(cell.nees[0].series.average[0], (1.0 + 0.01) / 2.0, 1e-12);
    EXPECT_NEAR(cell.nees[0].series.average[1], 0.01, 1e-12);
    EXPECT_EQ(cell.over_runs("numerical_faults").mean, 0.5);
  }
}

TEST_F(Judge, AVectorHasItsOwnDimension) {
  const std::string header = "time_s,a_m,b_mps,cov_0_0,cov_0_1,cov_1_1\n";
  write("e_0.csv", header + "1,1,2,1,0,4\n2,1,2,1,0,4\n");
  write("e_1.csv", header + "1,1,0,1,0,4\n2,1,0,1,0,4\n");
  write("truth.csv", "time_s,a_m,b_mps\n1,0,0\n2,0,0\n");
  const std::vector<std::string> more = {"--truth", "truth.csv", "-o", "mine.h5", "--error"};
  auto words = more;
  words.push_back("world");
  const Called called = judge({"e_0.csv", "e_1.csv"}, words);
  ASSERT_EQ(called.code, 0) << called.err;
  const analysis::StudyAnalysis study = analyzed("mine.h5");
  ASSERT_EQ(study.cells[0].nees.size(), 1U);
  EXPECT_EQ(study.cells[0].nees[0].series.dimension, 2U);
  EXPECT_NEAR(study.cells[0].nees[0].mean, 1.5, 1e-12);
  EXPECT_THAT(call({"analyze", "mine.h5", "--table", "verdict"}).out, HasSubstr("(a, b)"));
  EXPECT_EQ(call({"report", "mine.h5", "-o", "page"}).code, 0);
  EXPECT_THAT(call({"compare", "mine.h5", "--baseline", "e"}).err, HasSubstr("has one cell, e"));
  words.back() = "body";
  EXPECT_THAT(judge({"e_0.csv", "e_1.csv"}, words).err, HasSubstr("not of a vector"));
}

TEST_F(Judge, PosesInSpaceAreJudgedAndCompared) {
  std::string header = "time_s,x_m,y_m,z_m,qx,qy,qz,qw";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) header += ",cov_" + std::to_string(i) + "_" + std::to_string(j);
  }
  std::string P;
  for (int k = 0; k < 36; ++k) P += k % 7 == 0 ? ",0.01" : ",0";
  for (const char* cell : {"good", "bold"}) {
    std::filesystem::create_directory(folder_ / cell);
    const std::string x = cell == std::string("good") ? "0.2" : "0.6";
    for (const char* run : {"/run_0.csv", "/run_1.csv"})
      write(cell + std::string(run), header + "\n1," + x + ",0,0,0,0,0,1" + P + "\n");
  }
  write("truth.csv", "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0.5,0,0,0,0,0,0,1\n1.5,0,0,0,0,0,0,1\n");
  const std::vector<std::string> files = {"good/run_0.csv", "good/run_1.csv", "bold/run_0.csv",
                                          "bold/run_1.csv"};
  std::vector<std::string> more = {"--truth",         "truth.csv", "--error",
                                   "right-invariant", "-o",        "mine.h5"};
  EXPECT_THAT(judge(files, more).err, HasSubstr("--interpolate"));
  std::vector<std::string> with_number = more, with_gap = more;
  with_number.insert(with_number.end(), {"--interpolate", "5"});
  with_gap.insert(with_gap.end(), {"--longest-gap", "1e3"});
  EXPECT_THAT(judge(files, with_number).err, HasSubstr("--longest-gap 5"));
  EXPECT_EQ(judge(files, with_gap).code, 0) << "it interpolates";
  std::filesystem::remove(folder_ / "mine.h5");
  more.push_back("--interpolate");
  const Called called = judge(files, more);
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(testing::PrintToString(called.out),
              HasSubstr("Hint, no verdict: good: the verdict is"));
  const analysis::StudyAnalysis study = analyzed("mine.h5");
  EXPECT_NEAR(study.cells[0].nees[0].mean, 36.0, 1e-9);  // bold: 0.6^2 / 0.01
  EXPECT_NEAR(study.cells[1].nees[0].mean, 4.0, 1e-9);
  EXPECT_EQ(study.cells[0].nees[0].series.dimension, 6U);
  EXPECT_EQ(call({"report", "mine.h5", "-o", "page"}).code, 0);
  const Called compared = call({"compare", "mine.h5", "--baseline", "good"});
  EXPECT_THAT(compared.out, HasSubstr("NEES ratio  bold")) << compared.out << compared.err;
}

TEST_F(Judge, WrongInputIsNamed) {
  EXPECT_THAT(judged(kHeader + "1,0,0,0,1,0,0,0,1,0,0,0,1\n3,0,0,0,1,0,0,0,1,0,0,0,1\n").err,
              HasSubstr("e_0.csv:3: time 3 s has no truth in truth.csv"));
  EXPECT_FALSE(exists("mine.h5") || exists("mine.h5.part"));
  EXPECT_THAT(judged("").err, HasSubstr("e_0.csv: empty"));
  EXPECT_THAT(
      judged(kHeader + "1,0,0,0,1,0,0,0,1,0,0,0,1\n2,0,0,0,1,0,0,0,1,0,0,0,1\n", "wrold").err,
      HasSubstr("did you mean world"));
  const Called none = judge({"e_0.csv"}, {"--truth", "truth.csv", "-o", "mine.h5"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("--error is missing"));
  EXPECT_THAT(judge({"e_0.csv"}, {"--error", "world", "-o", "mine.h5"}).err,
              HasSubstr("--truth PATH... is missing"));
  EXPECT_THAT(judge({"e_0.csv"}, {"--error", "world", "-o", "m.h5", "--truth", "nowhere.csv"}).err,
              HasSubstr("nowhere.csv: cannot be opened"));
  EXPECT_THAT(call({"judge", "--help"}).out,
              AllOf(HasSubstr("run 7"), HasSubstr("right-invariant")));
}

// Variances that stand for "not measured", or for a component that cannot move.
TEST_F(Judge, MarksAreNamedAndTablesHaveNoInfinity) {
  for (const std::string mark : {"0", "1.7976931348623157e308"}) {
    const std::string P = ",1,0,0,0,1,0,0,0," + mark + "\n";
    write("e_0.csv", kHeader + "1,0.1,0,1e-7" + P + "2,0,0.1,0" + P);
    write("e_1.csv", kHeader + "1,0.1,0,0" + P + "2,0.3,0.1,-1e-7" + P);
    write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n2,0,0,0\n");
    const Called called = judge({"e_0.csv", "e_1.csv"}, {"--truth", "truth.csv", "--error", "world",
                                                         "-o", "mine.h5", "--force"});
    EXPECT_THAT(called.err, HasSubstr("e: heading has the variance "));
    EXPECT_THAT(called.out, Not(HasSubstr("deviation of 0"))) << "single precision explains it";
    EXPECT_THAT(call({"analyze", "mine.h5", "--all"}).out, Not(HasSubstr(" inf")));
  }
}

TEST_F(Judge, OneOfTwoEstimatesOfOneTimeIsKept) {
  const std::string header = "time_s,a,cov_0_0\n";
  for (const std::string run : {"0", "1", "2"}) {
    write("e_" + run + ".csv", header + "1,9,1\n1," + run + ",1\n2,0." + run + ",1\n");
  }
  write("truth.csv", "time_s,a\n1,0.5\n2,0\n");
  const std::vector<std::string> files = {"e_0.csv", "e_1.csv", "e_2.csv"};
  EXPECT_THAT(judge(files, {"--truth", "truth.csv", "-o", "mine.h5"}).err, HasSubstr("--keep"));
  const Called called = judge(files, {"--truth", "truth.csv", "-o", "mine.h5", "--keep", "last"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.err, HasSubstr("3 rows are left out by --keep, the first in e_0.csv"));
  EXPECT_NEAR(analyzed("mine.h5").cells[0].nees[0].series.average[0], (0.25 + 0.25 + 2.25) / 3,
              1e-12);
}

TEST_F(Judge, SeedsAreRunsAndAYawIsAHeading) {
  const std::string P = "cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2";
  for (const std::string seed : {"7", "42", "1337"}) {
    write("e_" + seed + ".csv",
          "time_s,x_m,y_m,yaw_rad," + P + "\n1," + seed + ",0,0,1,0,0,1,0,1\n");
  }
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n");
  const std::vector<std::string> files = {"e_7.csv", "e_42.csv", "e_1337.csv"};
  EXPECT_THAT(judge(files, {"--truth", "truth.csv", "-o", "mine.h5"}).err,
              HasSubstr("--error is missing"));
  const Called called = judge(files, {"--truth", "truth.csv", "--error", "body", "-o", "mine.h5"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.err, HasSubstr("7, 42, 1337"));
  const ResultFile file(folder_ / "mine.h5");
  EXPECT_THAT(file.runs(), ElementsAre(0, 1, 2));
  EXPECT_THAT(file.study_text(), HasSubstr("names of runs = 7, 42, 1337"));
}

TEST_F(Judge, ARunIsOneRunWhateverItsNumber) {
  write("e_3.csv", "time_s,a,cov_0_0\n1,0.1,1\n");
  write("truth.csv", "time_s,a\n1,0\n");
  const Called called = judge({"e_3.csv"}, {"--truth", "truth.csv", "-o", "mine.h5"});
  EXPECT_THAT(called.out, HasSubstr(": 1 run, "));
  EXPECT_THAT(call({"info", "mine.h5"}).out, HasSubstr("1 of 1"));
}

TEST_F(Judge, AVectorThatMayBeAPoseNeedsAnError) {
  const std::string P = "cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2";
  write("e_0.csv", "time_s,x_m,y_m,alpha_rad," + P + "\n1,0,0,0,1,0,0,1,0,1\n");
  write("truth.csv", "time_s,x_m,y_m,alpha_rad\n1,0.5,0,0\n");
  const std::vector<std::string> more = {"--truth", "truth.csv", "-o", "mine.h5"};
  EXPECT_THAT(judge({"e_0.csv"}, more).err,
              AllOf(HasSubstr("--error is missing"), HasSubstr("rename alpha_rad to heading_rad")));
  auto words = more;
  words.insert(words.end(), {"--error", "body"});
  EXPECT_THAT(judge({"e_0.csv"}, words).err, HasSubstr("rename alpha_rad to heading_rad"));
  words.back() = "world";
  EXPECT_EQ(judge({"e_0.csv"}, words).code, 0);
}

// Averages over runs are taken at each time, of one state.
/// Runs of a state x whose errors the tests choose, judged with truths of their own.
class JudgeTimes : public Judge {
 protected:
  /// Writes estimates and truth of a run; the error of each row is `error`, its variance 1.
  void write_run(int run, const std::vector<double>& times, double error) {
    std::string estimate = "time_s,x_m,cov_0_0\n", truth = "time_s,x_m\n";
    for (const double t : times) {
      estimate += to_text(t) + "," + to_text(100.0 * t + error) + ",1\n";
      truth += to_text(t) + "," + to_text(100.0 * t) + "\n";
    }
    write("e_" + std::to_string(run) + ".csv", estimate);
    write("truth_" + std::to_string(run) + ".csv", truth);
  }
  Called judged(const std::vector<std::string>& options = {}) {
    std::vector<std::string> words = {"--truth",     "truth_0.csv", "truth_1.csv",
                                      "truth_2.csv", "--error",     "world",
                                      "-o",          "mine.h5",     "--force"};
    words.insert(words.end(), options.begin(), options.end());
    return judge({"e_0.csv", "e_1.csv", "e_2.csv"}, words);
  }
  /// The errors in the file, {run, scan}; NaN where there is none.
  std::vector<double> errors() {
    const ResultFile file(folder_ / "mine.h5");
    const std::size_t scans = file.scan_times().size();
    std::vector<double> all(file.runs().size() * scans);
    for (std::size_t run = 0; run < file.runs().size(); ++run)
      file.read(file.cells().front(), "error", run, std::span(all).subspan(run * scans, scans));
    return all;
  }
};

TEST_F(Judge, ComponentsMayBeJudgedByThemselves) {
  for (const std::string run : {"0", "1", "2"})
    write("e_" + run + ".csv", kHeader + "1,0.5,9,0.25,4,1,2,1,1,0.5,2,0.5,3\n");
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n");
  const auto judged = [&](const std::string& components) {
    return judge({"e_0.csv", "e_1.csv", "e_2.csv"},
                 {"--truth", "truth.csv", "--error", "world", "-o", "mine.h5", "--force",
                  "--components", components});
  };
  EXPECT_THAT(judged("heading,x").out, HasSubstr("components x, heading"));
  const ResultFile file(folder_ / "mine.h5");
  std::vector<double> error(2), covariance(4);
  file.read(file.cells().front(), "error", 0, std::span(error));
  file.read(file.cells().front(), "error_covariance", 0, std::span(covariance));
  EXPECT_THAT(error, ElementsAre(0.5, 0.25));
  EXPECT_THAT(covariance, ElementsAre(4, 2, 2, 3));
  EXPECT_THAT(judged("x,z").err, HasSubstr("no component 'z' (the state has x,y,heading)"));
}

TEST_F(Judge, InnovationsAloneNeedNoTruth) {
  RngStream draw({.seed = 9, .run = 0, .purpose = Draw::test});
  for (const std::string run : {"0", "1"}) {
    std::string text = "time_s,range_m,bearing_rad,cov_0_0,cov_0_1,cov_1_1\n";
    for (int k = 0; k < 200; ++k) {
      text += to_text(0.5 * (k / 2)) + "," + to_text(2.0 * draw.normal()) + "," +
              to_text(0.2 * draw.normal()) +
              ",1,0,0.01\n";  // two of one time; four times too large
    }
    write("innovation_" + run + ".csv", text);
  }
  const std::vector<std::string> files = {"innovation_0.csv", "innovation_1.csv"};
  const Called called = judge(files, {"--innovations", "-o", "mine.h5"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out,
              AllOf(HasSubstr("innovation, innovations: white."),
                    HasSubstr("2 runs, 100 scans each"), HasSubstr("innovation is optimistic")));
  EXPECT_EQ(call({"gate", "mine.h5"}).code, 4);
  EXPECT_EQ(call({"report", "mine.h5", "-o", "report"}).code, 0);
  EXPECT_THAT(judge(files, {"--innovations", "-o", "m.h5", "--truth", "t.csv"}).err,
              HasSubstr("--truth: not beside --innovations"));
  write("innovation_1.csv", text_of("innovation_0.csv"));
  EXPECT_THAT(judge(files, {"--innovations", "-o", "m.h5"}).err,
              HasSubstr("innovation_1.csv: has the innovations of innovation_0.csv"));
  write("innovation_1.csv", "time_s,range_m,cov_0_0\n2,1,1\n1,1,1\n");
  EXPECT_THAT(judge(files, {"--innovations", "-o", "m.h5"}).err, HasSubstr("innovation_1.csv:3"));
  EXPECT_FALSE(exists("m.h5"));
}

TEST_F(Judge, RunsThatAreNotAlikeAreNamed) {
  write("truth_0.csv", "time_s,x_m\n1,0\n2,0\n");
  write("e_0.csv", "time_s,x_m,cov_0_0\n1,0,1\n2,0,1\n");
  write("truth_1.csv", "time_s,x_m,v_mps\n1,0,0\n2,0,0\n");
  write("e_1.csv", "time_s,x_m,v_mps,cov_0_0,cov_0_1,cov_1_1\n1,0,0,1,0,1\n2,0,0,1,0,1\n");
  EXPECT_THAT(judge({"e_0.csv", "e_1.csv"},
                    {"--truth", "truth_0.csv", "truth_1.csv", "--error", "world", "-o", "mine.h5"})
                  .err,
              HasSubstr("e_1.csv: another state than in e_0.csv"));
  EXPECT_FALSE(exists("mine.h5"));
}

TEST_F(JudgeTimes, AreThoseOfEachRowEvenIfClocksDiffer) {
  write_run(0, {0, 1, 2, 3}, 0.5);
  write_run(1, {0.004, 1.004, 2.004, 3.004}, 1.5);
  write_run(2, {0, 1, 2, 3}, -2.5);
  judged({"--tolerance", "0.01"});
  const std::vector<double> expected = {0.5, 0.5, 0.5,  0.5,  1.5,  1.5,
                                        1.5, 1.5, -2.5, -2.5, -2.5, -2.5};
  EXPECT_THAT(errors(), testing::Pointwise(testing::DoubleNear(1e-9), expected));
  write_run(0, {5.3, 6.3, 7.3, 8.3}, 0.5);
  write_run(1, {0.1, 1.2, 2.1, 3.4}, 1.5);
  EXPECT_THAT(judged().err, HasSubstr("runs have clocks of their own"));
  EXPECT_THAT(errors(), testing::Pointwise(testing::DoubleNear(1e-9), expected));
}

TEST_F(JudgeTimes, MayLackSamplesWhichAreCounted) {
  write_run(0, {0, 1, 2, 3}, 0.5);
  write_run(1, {2, 3}, 1.5);
  write_run(2, {0, 2, 3}, -2.5);
  const Called called = judged();
  EXPECT_THAT(called.err, HasSubstr("3 samples are missing"));
  EXPECT_THAT(called.out, HasSubstr("3 of 12 samples are missing"));
  const std::vector<double> expected = {0.5, 0.5, 0.5,  0.5, NAN,  NAN,
                                        1.5, 1.5, -2.5, NAN, -2.5, -2.5};
  EXPECT_THAT(errors(), testing::Pointwise(testing::NanSensitiveDoubleNear(1e-9), expected));
}

TEST_F(JudgeTimes, AreRefusedIfTheToleranceCannotTellScansApart) {
  for (const int run : {0, 1, 2}) write_run(run, {0, 0.5, 1, 1.5}, 1.0);
  EXPECT_THAT(judged({"--tolerance", "0.26"}).err,
              HasSubstr("half of that cannot tell neighbours apart"));
  EXPECT_EQ(judged({"--tolerance", "0.24"}).code, 0);
}

// Other input of 'montecarta judge' than one CSV file a run, and its part in the result.
class JudgeLayouts : public Judge {
 protected:
  Called judge_by(const std::string& error, const std::vector<std::string>& files,
                  const std::vector<std::string>& more = {"--force"}) const {
    std::vector<std::string> options = {"--truth", "truth.csv", "--error", error, "-o", "mine.h5"};
    options.insert(options.end(), more.begin(), more.end());
    return judge(files, options);
  }
  /// Two estimates and their truth.
  void write_estimates() const {
    const std::string header = "time_s,x_m,y_m,cov_0_0,cov_0_1,cov_1_1\n";
    write("e_0.csv", header + "1,0.3,0,0.01,0,0.09\n");
    write("e_1.csv", header + "1,0,0.6,0.01,0,0.09\n");
    write("truth.csv", "time_s,x_m,y_m\n1,0,0\n");
  }
};

TEST_F(JudgeLayouts, ATrajectoryIsSentToItsConverter) {
  write("e_0.txt", "# timestamp tx ty tz qx qy qz qw\n1 0.3 0 0 0 0 0 1\n");
  write("truth.csv", "time_s,x_m,y_m\n1,0,0\n");
  EXPECT_THAT(judge_by("world", {"e_0.txt"}).err, HasSubstr("e_0.txt:2"));
}

// The same estimates are another study with other innovations beside.
TEST_F(JudgeLayouts, WhatLiesBesideIsJudgedAndPartOfTheStudy) {
  write_estimates();
  std::filesystem::create_directory(folder_ / "run_0");
  std::filesystem::create_directory(folder_ / "run_1");
  for (const char* run : {"0", "1"}) {
    const std::string to = "run_" + std::string(run);
    write(to + "/estimate.csv", text_of("e_" + std::string(run) + ".csv"));
    write(to + "/innovation.csv", "time_s,nis,nis_dof\n1,6,2\n");
  }
  const std::vector<std::string> files = {"run_0/estimate.csv", "run_1/estimate.csv"};
  ASSERT_EQ(judge_by("world", files).code, 0);
  const ResultFile file(folder_ / "mine.h5");
  const auto numbers = numbers_of(analysis::analyze(file).cells[0]);
  const auto nis = std::ranges::find(numbers, "nis_per_component", &analysis::Frame::Entry::name);
  EXPECT_NEAR(nis->number, 3.0, 1e-12);
  write("run_1/innovation.csv", "time_s,nis,nis_dof\n1,5,2\n");
  ASSERT_EQ(judge_by("world", files).code, 0);
  EXPECT_NE(ResultFile(folder_ / "mine.h5").study_sha256(), file.study_sha256());
  std::filesystem::remove(folder_ / "run_1/innovation.csv");
  EXPECT_THAT(judge_by("world", files).err, HasSubstr("estimate.csv: no nis"));
}

TEST_F(JudgeLayouts, InnovationsOfAnAngleBeyondPiAreNoted) {
  write_estimates();
  std::filesystem::create_directory(folder_ / "run_0");
  std::filesystem::create_directory(folder_ / "run_1");
  for (const char* run : {"0", "1"}) {
    const std::string to = "run_" + std::string(run);
    write(to + "/estimate.csv", text_of("e_" + std::string(run) + ".csv"));
    write(to + "/innovation.csv", "time_s,bearing_rad,cov_0_0\n1,6.25,1\n");
  }
  const std::vector<std::string> files = {"run_0/estimate.csv", "run_1/estimate.csv"};
  EXPECT_THAT(judge_by("world", files).err,
              HasSubstr("beyond pi: 2, the first in run_0/innovation.csv:2: bearing_rad 6.25"));
  write("run_0/innovation.csv", "time_s,bearing_rad,cov_0_0\n1,0.25,1\n");
  write("run_1/innovation.csv", "time_s,bearing_rad,cov_0_0\n1,0.25,1\n");
  EXPECT_THAT(judge_by("world", files).err, Not(HasSubstr("beyond pi")));
}

TEST_F(JudgeLayouts, TheHintIsSaidByAnalyzeAndReportFromTheFileAlone) {
  std::string P = ",0.01,0,0,0,1,0,0,0,0.01\n", header = "time_s,x_m,y_m,heading_rad";
  for (int k = 0; k < 9; ++k)
    header += ",cov_" + std::to_string(k / 3) + "_" + std::to_string(k % 3);
  // Headed along y, the small deviation is across in the frame of the body.
  std::vector<std::string> files;
  for (int run = 0; run < 20; ++run) {
    const double e = run % 2 == 0 ? 1.0 : -1.0;
    files.push_back("e_" + std::to_string(run) + ".csv");
    write(files.back(), header + "\n1," + std::to_string(-e) + "," + std::to_string(0.1 * e) +
                            ",1.5707963267948966" + P);
  }
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,1.4707963267948966\n");
  ASSERT_EQ(judge_by("world", files).code, 0);
  const auto is_hint = AllOf(HasSubstr("Hint, no verdict: "), HasSubstr("body (NEES ratio"));
  EXPECT_THAT(call({"analyze", "mine.h5"}).out, is_hint);
  ASSERT_EQ(call({"report", "mine.h5", "-o", "page"}).code, 0);
  EXPECT_THAT(text_of("page/index.html"), HasSubstr("Hint, no verdict: "));
  EXPECT_EQ(call({"gate", "mine.h5", "--cell", "e"}).code, 4) << "a hint is no verdict";
}

TEST_F(JudgeLayouts, TheMarginIsStored) {
  write_estimates();
  ASSERT_EQ(judge_by("world", {"e_0.csv", "e_1.csv"}, {"--within", "1.7"}).code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, 1.7);
  ASSERT_EQ(judge_by("world", {"e_0.csv", "e_1.csv"}).code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, analysis::kUsualMargin);
}

TEST_F(JudgeLayouts, TwoComponentsOfOneNameAreToldApart) {
  write("e_0.csv", "time_s,v_m,v_rad,cov_0_0,cov_0_1,cov_1_1\n1,1,1,1,0,1\n");
  write("truth.csv", "time_s,v_m,v_rad\n1,1,1\n");
  EXPECT_THAT(judge_by("world", {"e_0.csv"}).err,
              HasSubstr("e_0.csv:1: 'v_m' and 'v_rad' are both"));
}

}  // namespace
}  // namespace montecarta::experiments
