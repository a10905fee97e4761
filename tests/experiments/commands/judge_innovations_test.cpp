// SPDX-License-Identifier: BSD-3-Clause
// Innovations by sensor and behind a gate, and two estimators without a truth.
#include "analysis/run/criteria_of.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/innovations.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

class JudgeInnovations : public BlinkProgram {
 protected:
  Called judged(const std::vector<std::string>& files, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"judge"};
    words.insert(words.end(), files.begin(), files.end());
    words.insert(words.end(), {"-o", "mine.h5", "--force"});
    return call_with(words, more);
  }
  std::vector<double> column_of(const std::string& cell, const std::string& name) const {
    const ResultFile file(folder_ / "mine.h5");
    std::vector<double> column(file.times().size());
    for (const StoredCell& stored : file.cells()) {
      if (stored.label == cell) file.read(stored, name, 0, std::span(column));
    }
    return column;
  }
};

TEST_F(JudgeInnovations, OfSeveralSensorsAreJudgedSensorBySensor) {
  write("i_0.csv", "time_s,sensor,nis,nis_dof\n1,gps,2,2\n1,lidar,3,3\n2,lidar,6,3\n");
  write("i_1.csv", "time_s,sensor,nis,nis_dof\n1,lidar,3,3\n2,lidar,4,3\n3,lidar,5,3\n");
  const Called called = judged({"i_0.csv", "i_1.csv"}, {"--innovations"});
  ASSERT_EQ(called.code, 0) << called.err;
  const ResultFile file(folder_ / "mine.h5");
  std::vector<std::string> labels;
  for (const StoredCell& cell : file.cells()) labels.push_back(cell.label);
  EXPECT_THAT(labels, ElementsAre("i.gps", "i.lidar"));
  EXPECT_EQ(analysis::criteria_of(file, 0.95, 1.1).level_of_each(), 1.0 - 0.05 / 4.0)
      << "whiteness and size of two sensors";
  EXPECT_EQ(column_of("i.gps", "nis")[0], 2.0);
  EXPECT_EQ(column_of("i.gps", "nis")[1], 0.0) << "nothing was observed";
  EXPECT_EQ(column_of("i.lidar", "nis")[1], 6.0);
  write("bad_0.csv", "time_s,sensor,nis,nis_dof\n1,,2,2\n");
  EXPECT_THAT(judged({"bad_0.csv"}, {"--innovations"}).err, HasSubstr("bad_0.csv:2: no sensor"));
  write("bad_0.csv", "time_s,sensor,nis,nis_dof\n1,a b,2,2\n2,c,2,2\n");
  EXPECT_THAT(judged({"bad_0.csv"}, {"--innovations"}).err,
              AllOf(HasSubstr("'bad.a b' cannot label a cell"), HasSubstr("): rename the sensor")));
  write("e.csv", "time_s,sensor,a,cov_0_0\n1,gps,2,2\n");
  EXPECT_THAT(judged({"e.csv"}, {"--truth", "e.csv"}).err,
              HasSubstr("'sensor' names the sensor of an innovation"));
}

TEST_F(JudgeInnovations, BehindAGateArePutOnTheScaleWithoutOne) {
  write("i.csv", "time_s,nis,nis_dof\n1,9,2\n2,1,2\n3,0,0\n4,5,1\n");
  const Called called = judged({"i.csv"}, {"--innovations", "--gate", "9"});
  ASSERT_EQ(called.code, 0) << called.err;
  const std::vector<double> nis = column_of("i", "nis");
  EXPECT_GT(nis[0], 20.0) << "the largest that the gate lets pass";
  EXPECT_NEAR(nis[1], analysis::chi_squared_before_gate(1.0, 2.0, 9.0), 1e-12);
  EXPECT_EQ(nis[2], 0.0);
  EXPECT_THAT(call({"analyze", "mine.h5", "--table", "innovations"}).out,
              HasSubstr("as if without"))
      << "the given NIS is not stored";
  EXPECT_THAT(called.out, ContainsRegex("innovations[ \n]+passes: i \\(9\\)"));
  EXPECT_THAT(judged({"i.csv"}, {"--innovations", "--gate", "8"}).err,
              HasSubstr("i.csv:2: a NIS of 9 is beyond --gate 8"));
  for (const std::string share : {"99", "0.99"}) {
    EXPECT_THAT(judged({"i.csv"}, {"--innovations", "--gate", share}).err, HasSubstr("Write 99%"));
  }
  EXPECT_THAT(judged({"i.csv"}, {"--innovations", "--gate", "99.9%"}).err,
              HasSubstr("stored in mine.h5"));
  EXPECT_THAT(judged({"i.csv"}, {"--gate", "8"}).err, HasSubstr("--gate: needs --innovations"));
  write("z.csv", "time_s,nis,nis_dof\n1,0,2\n2,0,2\n");
  EXPECT_THAT(judged({"z.csv"}, {"--innovations", "--gate", "0.0001%"}).err,
              HasSubstr("--gate 0.0001%: a limit of"))
      << "and nothing is stored that is damaged";
  EXPECT_THAT(judged({"i.csv"}, {"--innovations", "--error", "world"}).err,
              HasSubstr("--error: not beside --innovations"));
}

/// NIS of two components, `factor` times those of a right filter, of a GPS and of a lidar; a gate
/// of `limit` lets those of the lidar pass.
std::string sensors_with_a_gate(double factor, double limit, int rows = 1500,
                                std::uint64_t run = 0) {
  RngStream draw({21, run, 0, 0, Draw::test});
  std::string text = "time_s,sensor,nis,nis_dof\n";
  for (int k = 0; k < rows; ++k) {
    for (const char* const sensor : {"gps", "lidar"}) {
      const double nis = -2.0 * factor * std::log(1.0 - draw.uniform());
      if (sensor == std::string("lidar") && nis > limit) continue;
      text += std::to_string(k) + "," + sensor + "," + to_text(nis) + ",2\n";
    }
  }
  return text;
}

/// NIS of two components of two sensors; those of the camera are `share` of the one before and the
/// rest of a new one.
std::string sensors_of_which_one_remembers(double share, std::uint64_t run) {
  RngStream draw({22, run, 0, 0, Draw::test});
  std::string text = "time_s,sensor,nis,nis_dof\n";
  double before = 2.0;
  for (int k = 0; k < 400; ++k) {
    const double gps = -2.0 * std::log(1.0 - draw.uniform());
    before = share * before - 2.0 * (1.0 - share) * std::log(1.0 - draw.uniform());
    text += std::to_string(k) + ",gps," + to_text(gps) + ",2\n";
    text += std::to_string(k) + ",camera," + to_text(before) + ",2\n";
  }
  return text;
}

// `montecarta gate` needs no truth for innovations, and none of the sensors may fail.
TEST_F(JudgeInnovations, AreGatedBySizeAndWhitenessOfEverySensor) {
  const auto judged_runs = [&](double factor, std::uint64_t runs, int rows) {
    std::vector<std::string> files;
    for (std::uint64_t run = 0; run < runs; ++run) {
      files.push_back("i_" + std::to_string(run) + ".csv");
      write(files.back(), sensors_with_a_gate(factor, 1e9, rows, run));
    }
    ASSERT_EQ(judged(files, {"--innovations"}).code, 0);
  };
  judged_runs(1.0, 12, 500);
  const Called right = call({"gate", "mine.h5", "--within", "1.2"});
  EXPECT_EQ(right.code, 0) << right.out << right.err;
  EXPECT_THAT(right.out, AllOf(HasSubstr("i.gps is consistent"), HasSubstr("i.lidar is ")));
  EXPECT_THAT(call({"gate", "mine.h5", "--json"}).out,
              AllOf(testing::StartsWith("["), HasSubstr("i.gps"), HasSubstr("i.lidar"),
                    HasSubstr("\"answer\": \"white\"")));
  judged_runs(2.0, 12, 500);
  EXPECT_EQ(call({"gate", "mine.h5"}).code, 4);
  judged_runs(1.0, 1, 6000);
  const Called one_drive = call({"gate", "mine.h5", "--within", "1.2"});
  EXPECT_EQ(one_drive.code, 5) << one_drive.out;
  EXPECT_THAT(one_drive.out, HasSubstr("The NIS alone of fewer than 10 drives"));
  judged_runs(1.0, 400, 3);
  EXPECT_THAT(call({"gate", "mine.h5", "--within", "2"}).out,
              HasSubstr("too few innovations in a run to tell whether they are white"));
}

TEST_F(JudgeInnovations, ThatAreNotWhiteDoNotPassAGate) {
  std::vector<std::string> files;
  for (std::uint64_t run = 0; run < 12; ++run) {
    files.push_back("i_" + std::to_string(run) + ".csv");
    write(files.back(), sensors_of_which_one_remembers(0.3, run));
  }
  ASSERT_EQ(judged(files, {"--innovations"}).code, 0);
  const Called called = call({"gate", "mine.h5", "--within", "1.5"});
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("The innovations are not white."));
  EXPECT_THAT(call({"gate", "mine.h5", "--within", "1.5", "--cell", "i.camera", "--json"}).out,
              HasSubstr("\"answer\": \"not white\""));
  EXPECT_EQ(call({"gate", "mine.h5", "--within", "1.5", "--cell", "i.gps"}).code, 0);
}

// A file of two filters is gated filter by filter.
TEST_F(JudgeInnovations, OfSeveralFiltersAreGatedOneByOne) {
  write("a_0.csv", "time_s,nis,nis_dof\n1,2,2\n2,1,2\n");
  write("b_0.csv", "time_s,nis,nis_dof\n1,3,2\n2,1,2\n");
  ASSERT_EQ(judged({"a_0.csv", "b_0.csv"}, {"--innovations"}).code, 0);
  EXPECT_THAT(call({"gate", "mine.h5"}).err, HasSubstr("--cell CELL is needed"));
}

// The gate of one sensor is not that of another, and both are judged together.
TEST_F(JudgeInnovations, MayHaveAGateOfOneSensor) {
  write("i.csv", sensors_with_a_gate(2.0, 9.0));
  const Called wrong = judged({"i.csv"}, {"--innovations", "--gate", "9"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("sensor gps has a NIS of"), HasSubstr("SENSOR=9")));
  const Called called = judged({"i.csv"}, {"--innovations", "--gate", "lidar=9"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("i.lidar (9)"));
  EXPECT_THAT(called.out, Not(HasSubstr("i.gps (")));
  EXPECT_THAT(called.err, Not(HasSubstr("if the filter leaves them out")));
  const auto study = analysis::analyze(ResultFile(folder_ / "mine.h5"), 0.95);
  for (const analysis::CellAnalysis& cell : study.cells) {
    const auto& found = cell.get<analysis::Innovations>();
    EXPECT_NEAR(found.ratio, 2.0, 0.25) << cell.label << ": a size, whatever the gate leaves out";
    EXPECT_EQ(found.verdict.answer, analysis::Answer::optimistic) << cell.label;
  }
  for (const std::string gate : {"lidr=9", "lidar=9,lidar=8", "=9", "lidar", "lidar=9,8"}) {
    EXPECT_EQ(judged({"i.csv"}, {"--innovations", "--gate", gate}).code, 2) << gate;
  }
  EXPECT_THAT(judged({"i.csv"}, {"--innovations", "--gate", "lidr=9"}).err, HasSubstr("lidar?"));
  write("j.csv", "time_s,nis,nis_dof\n1,2,2\n");
  EXPECT_THAT(judged({"j.csv"}, {"--innovations", "--gate", "lidar=9"}).err,
              HasSubstr("no sensor (the files have no column sensor): say --gate 9"));
  EXPECT_EQ(judged({"i.csv"}, {"--innovations", "--gate", "lidar=99%,gps=1000"}).code, 0);
  write("k_0.csv", "time_s,sensor,nis,nis_dof\n1,gps,2,2\n");
  write("k_1.csv", "time_s,nis,nis_dof\n1,3,2\n");
  EXPECT_THAT(judged({"k_0.csv", "k_1.csv"}, {"--innovations"}).err,
              HasSubstr("files with and without a column sensor"));
}

TEST_F(JudgeInnovations, ThatEndAtALimitMayHavePassedAGate) {
  const auto notes = [&](double factor, double limit) {
    write("i.csv", sensors_with_a_gate(factor, limit));
    return judged({"i.csv"}, {"--innovations"}).err;
  };
  EXPECT_THAT(notes(1.0, 9.0), AllOf(HasSubstr("no NIS of sensor lidar is beyond 9.00, where 1"),
                                     HasSubstr("say --gate lidar=9\n")));
  EXPECT_THAT(notes(2.0, 9.0), HasSubstr("say --gate lidar=9\n"));
  EXPECT_THAT(notes(1.5, analysis::chi_squared_quantile(0.95, 2.0)),
              HasSubstr("say --gate lidar=95%\n"));
  for (const double factor : {0.5, 1.0, 3.0})
    EXPECT_THAT(notes(factor, 1e9), Not(HasSubstr("--gate"))) << factor;
}

// Rows of one time are summed up, with the deviation of their sum.
/// A pose of a scan matcher, say, is an innovation and no state: it has no blocks.
TEST_F(JudgeInnovations, ThatArePosesAreJudgedAsAWhole) {
  std::vector<std::string> files;
  for (std::uint64_t run = 0; run < 12; ++run) {
    RngStream draw({12, run, 0, 0, Draw::test});
    std::string text =
        "time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2\n";
    for (int k = 0; k < 20; ++k) {
      text += std::to_string(k) + "," + to_text(draw.normal()) + "," + to_text(draw.normal()) +
              "," + to_text(0.01 * draw.normal()) + ",1,0,0,1,0,1e-4\n";
    }
    files.push_back("i_" + std::to_string(run) + ".csv");
    write(files.back(), text);
  }
  const Called called = judged(files, {"--innovations"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, Not(HasSubstr("  position")));
}

// A bias of one sensor is no bias of another: their sum would be right.
TEST_F(JudgeInnovations, OfSensorsWithOppositeFaultsAreBothOff) {
  std::vector<std::string> files;
  for (std::uint64_t run = 0; run < 20; ++run) {
    RngStream draw({9, run, 0, 0, Draw::test});
    std::string text = "time_s,sensor,gap_m,cov_0_0\n";
    for (int k = 0; k < 50; ++k) {
      text += std::to_string(k) + ",left," + to_text(draw.normal() + 0.5) + ",1\n";
      text += std::to_string(k) + ",right," + to_text(draw.normal() - 0.5) + ",1\n";
    }
    files.push_back("i_" + std::to_string(run) + ".csv");
    write(files.back(), text);
  }
  ASSERT_EQ(judged(files, {"--innovations"}).code, 0);
  const auto study = analysis::analyze(ResultFile(folder_ / "mine.h5"), 0.95);
  ASSERT_EQ(study.cells.size(), 2U);
  for (const analysis::CellAnalysis& cell : study.cells) {
    const analysis::FamilyTest* bias = cell.verdict.find(analysis::Family::bias);
    ASSERT_NE(bias, nullptr);
    EXPECT_TRUE(bias->is_rejected) << cell.label;
    const auto& found = cell.get<analysis::Innovations>();
    EXPECT_TRUE(found.components.front().has_bias()) << cell.label;
    EXPECT_FALSE(found.judges_size()) << "the verdict on errors does";
  }
  // Whiteness and size of two sensors are judged together; the average NEES is by itself.
  const auto table = [&](const char* name) {
    return call({"analyze", "mine.h5", "--table", name}).out;
  };
  EXPECT_THAT(table("innovations"), HasSubstr("[98.75 %]"));
  EXPECT_THAT(table("innovations"), Not(HasSubstr("[95 %]")));
  EXPECT_THAT(table("consistency"), HasSubstr("[95 %]"));
  EXPECT_THAT(table("consistency"), Not(HasSubstr("[98.75 %]")));
  ASSERT_EQ(call({"analyze", "mine.h5", "--csv", "csv"}).code, 0);
  EXPECT_THAT(text_of("csv/families.csv"), AllOf(HasSubstr(",level"), HasSubstr(",0.9875\n")));
}

TEST_F(JudgeInnovations, WithComponentsHaveABiasAndCorrelations) {
  std::vector<std::string> files;
  for (std::uint64_t run = 0; run < 20; ++run) {
    RngStream draw({8, run, 0, 0, Draw::test});
    std::string text = "time_s,gap_m,cov_0_0\n";
    for (int k = 0; k < 50; ++k) {
      text += std::to_string(k / 2) + "," + to_text(2.0 * (draw.normal() + 0.5)) + ",4\n";
    }
    files.push_back("i_" + std::to_string(run) + ".csv");
    write(files.back(), text);
  }
  const Called called = judged(files, {"--innovations"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, AllOf(HasSubstr("a bias in gap of 0."), HasSubstr("25 scans each"),
                                HasSubstr("judged as the errors of predicted measurements")));
  EXPECT_THAT(called.out, Not(HasSubstr("missing")));
  const std::vector<double> nis = column_of("i", "nis");
  EXPECT_EQ(column_of("i", "error_covariance"), std::vector<double>(25, 4.0));
  EXPECT_GT(nis[0], 0.0);
}

/// Estimates of one component over 20 rows with variance 1, whose errors have the deviation
/// `deviation` and are all those of the draw `seed`.
std::string estimates_with(double deviation, std::uint64_t run, std::uint32_t seed) {
  RngStream draw({7, run, 0, seed, Draw::test});
  std::string text = "time_s,a_m,cov_a_a\n";
  for (int k = 0; k < 20; ++k) {
    text += std::to_string(k) + "," + to_text(3.0 * k + deviation * draw.normal()) + ",1\n";
  }
  return text;
}

// Law: two consistent estimators are not called off by their difference, whatever their correlation
// is; if one of them is off by enough, it is.
TEST_F(JudgeInnovations, OrTheDifferenceOfTwoEstimatorsNeedNoTruth) {
  std::vector<std::string> files, bold, same;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const std::string ending = "_" + std::to_string(run) + ".csv";
    write("a" + ending, estimates_with(1.0, run, 1));
    write("b" + ending, estimates_with(1.0, run, 2));
    write("c" + ending, estimates_with(3.0, run, 3));
    write("d" + ending, estimates_with(1.001, run, 1));
    for (const char* of : {"a", "b"}) files.push_back(of + ending);
    for (const char* of : {"a", "c"}) bold.push_back(of + ending);
    for (const char* of : {"a", "d"}) same.push_back(of + ending);
  }
  const auto words = [&](const std::vector<std::string>& of) {
    const Called called = judged(of, {"--pair"});
    EXPECT_EQ(called.code, 0) << called.err;
    return called.out;
  };
  EXPECT_THAT(words(files), AllOf(HasSubstr("a-b is undecided: its errors are not shown to be "
                                            "larger than they may be at most"),
                                  HasSubstr("the differences of a and b, without a truth")));
  EXPECT_EQ(call({"gate", "mine.h5"}).code, 5);
  EXPECT_THAT(words(same), HasSubstr("a-d is undecided"));
  EXPECT_THAT(words(bold), HasSubstr("a-c is optimistic"));
  EXPECT_EQ(call({"gate", "mine.h5"}).code, 4);
  EXPECT_THAT(judged({"a_0.csv", "a_1.csv"}, {"--pair"}).err,
              HasSubstr("--pair: needs two estimators (1 was found)"));
}

// Two files are two estimators, and nothing is called a truth.
TEST_F(JudgeInnovations, OfAPairMayBeTwoFilesWithoutNumbers) {
  const std::string header = "time_s,a,cov_a_a\n";
  write("ekf.csv", header + "1,0,1\n2,0,1\n3,0,1\n");
  write("ukf.csv", header + "1,1,1\n2,2,1\n3,0,1\n");
  const Called called = judged({"ekf.csv", "ukf.csv"}, {"--pair"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("the differences of ekf and ukf, without a truth"));
  write("ukf.csv", header + "1.5,1,1\n2.5,2,1\n");
  EXPECT_THAT(judged({"ekf.csv", "ukf.csv"}, {"--pair"}).err,
              AllOf(HasSubstr("ekf.csv:2: time 1 s has no second estimate in ukf.csv"),
                    Not(HasSubstr("truth"))));
  write("ukf.csv", "time_s,b,cov_b_b\n1,1,1\n");
  EXPECT_THAT(judged({"ekf.csv", "ukf.csv"}, {"--pair"}).err,
              AllOf(HasSubstr("ukf.csv: another state"), Not(HasSubstr("truth"))));
}

TEST_F(JudgeInnovations, OfSensorsThatAreNotAlikeHaveARemedy) {
  write("i_0.csv", "time_s,Sensor,nis,nis_dof\n1,gps,2,2\n");
  EXPECT_THAT(judged({"i_0.csv"}, {"--innovations"}).err, HasSubstr("rename it to sensor"));
  write("i_0.csv", "time_s,gate,nis,nis_dof\n1,9,2,2\n");
  EXPECT_THAT(judged({"i_0.csv"}, {"--innovations"}).err, HasSubstr("beside gate"));
  write("i_0.csv", "time_s,sensor,range_m,speed_mps,cov_0_0,cov_1_1\n1,gps,2,,1,\n");
  EXPECT_THAT(judged({"i_0.csv"}, {"--innovations"}).err,
              AllOf(HasSubstr("i_0.csv:2: sensor gps has no speed_mps"),
                    HasSubstr("time_s,sensor,nis,nis_dof")));
}

// One run shows the bias of white innovations, which is said once.
TEST_F(JudgeInnovations, OfOneRunHaveABias) {
  std::string text = "time_s,gap_m,cov_0_0\n";
  RngStream draw({17, 0, 0, 0, Draw::test});
  for (int k = 0; k < 200; ++k)
    text += std::to_string(k) + "," + to_text(draw.normal() + 0.5) + ",1\n";
  write("i_0.csv", text);
  const Called called = judged({"i_0.csv"}, {"--innovations"});
  EXPECT_THAT(called.out, AllOf(HasSubstr("gap has a bias"), Not(HasSubstr("runs bias"))));
}

// The size of this drive is known by the law of white innovations, which says less of other drives.
TEST_F(JudgeInnovations, OfOneWhiteDriveHaveASizeOfTheirOwn) {
  std::string text = "time_s,gap_m,turn_rad,cov_0_0,cov_0_1,cov_1_1\n";
  RngStream draw({18, 0, 0, 0, Draw::test});
  for (int k = 0; k < 1500; ++k) {
    text += std::to_string(k) + "," + to_text(draw.normal()) + "," + to_text(0.1 * draw.normal()) +
            ",1,0,0.01\n";
  }
  std::filesystem::create_directories(folder_ / "1");
  write("1/i.csv", text);
  const Called called = judged({"1/i.csv"}, {"--innovations"});
  EXPECT_THAT(called.out, AllOf(HasSubstr("NIS ratio [97.5 %]"), Not(HasSubstr("NEES")),
                                ContainsRegex("over[ \n]+many[ \n]+drives")));
  const ResultFile file(folder_ / "mine.h5");
  EXPECT_EQ(file.runs(), std::vector<std::uint64_t>{0}) << "a folder's bare number is no run";
  const auto study = analysis::analyze(file, 0.95);
  const analysis::Verdict& found = study.cells.front().verdict;
  EXPECT_EQ(found.level, 0.975) << "whiteness and size are judged together";
  EXPECT_EQ(found.answer, analysis::Answer::undecided);
  EXPECT_LT(found.ratio().upper - found.ratio().lower, 0.2);
  EXPECT_GT(found.over_drives.upper, found.ratio().upper + 0.2);
  EXPECT_EQ(found.find(analysis::Family::component)->members.size(), 2U);
}

TEST_F(JudgeInnovations, AndArraysOfNumPyHaveARemedy) {
  write("err.npy", "\x93NUMPY");
  EXPECT_THAT(judged({"err.npy", "cov.npy"}, {}).err,
              AllOf(HasSubstr("err.npy: a NumPy array"), HasSubstr("montecarta.judge"),
                    HasSubstr("numpy.savez")));
}

}  // namespace
}  // namespace montecarta::experiments
