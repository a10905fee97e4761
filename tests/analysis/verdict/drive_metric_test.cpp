// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/drive_scores.hpp"
#include "analysis/run/nees.hpp"
#include "analysis/run/path_at_fixes.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "analysis/study/cell_sums.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// One after the other: arguments of a call have no order.
Eigen::Vector3d three_normals(RngStream& draw) {
  Eigen::Vector3d numbers;
  for (double& number : numbers) number = draw.normal();
  return numbers;
}

/// A drive of ten minutes along x with a scan and a fix a second.
class DriveOfTenMinutes : public ::testing::Test {
 protected:
  DriveOfTenMinutes() {
    for (std::size_t s = 0; s < 600; ++s) times_.push_back(static_cast<double>(s + 1));
    RngStream draw({.seed = 8, .purpose = Draw::test});
    for (const double time : times_) {
      reference_.time.push_back(time);
      const Eigen::Vector3d error = three_normals(draw);
      reference_.position.emplace_back(time + error(0), error(1));
      reference_.heading.push_back(0.1 * error(2));
      reference_.covariance.emplace_back(Eigen::Vector3d(1.0, 1.0, 0.01).asDiagonal());
    }
  }

  /// A run with errors of `ratio` times the covariance 1, 1, 0.01 that it reports; the errors of
  /// neighbouring scans, a second apart, have the correlation `keep`.
  RunRows run(double ratio, double keep, std::uint64_t number = 0) const {
    RngStream draw({.seed = 4, .run = number, .purpose = Draw::test});
    RunRows rows;
    Eigen::Vector3d error = three_normals(draw);
    for (const double time : times_) {
      const Eigen::Vector3d e = std::sqrt(ratio) * error;
      rows.spread.mean.insert(rows.spread.mean.end(), {time + e(0), e(1), 0.1 * e(2)});
      rows.spread.covariance.insert(rows.spread.covariance.end(), {1, 0, 0, 0, 1, 0, 0, 0, 0.01});
      error = keep * error + std::sqrt(1.0 - keep * keep) * three_normals(draw);
    }
    return rows;
  }

  DriveScores scores(RunRows rows) const {
    const PathAtFixes fixes(reference_, times_, {});
    rows.path.spread = rows.spread;
    return drive_scores(fixes, {}, rows, 0, 0.95);
  }
  DriveConsistency judged(const RunRows& rows, double within = kUsualMargin) const {
    const DriveScores one = scores(rows);
    return judge_drive(std::span(&one, 1), 0.95, within);
  }

  std::vector<double> times_;
  ReferencePath reference_{"reference", {}, {}, {}};
};

TEST_F(DriveOfTenMinutes, AFilterThatForgetsIsJudgedByTheDriveAndOneWithLastingErrorsIsNot) {
  EXPECT_THAT(in_words(judged(run(5.0, 0.3))), StartsWith("optimistic: NEES "));
  EXPECT_EQ(in_words(judged(run(1.0, 0.3), 3.0)), "consistent within 3");
  const DriveConsistency right = judged(run(1.0, 0.3));
  EXPECT_THAT(in_words(right), StartsWith("this drive cannot tell: it would need "));
  EXPECT_GT(right.minutes, 10.0);
  EXPECT_GT(right.mean.leads().effective_samples, 300.0);
  const DriveConsistency found = judged(run(1.0, 1.0 - 1e-9));
  EXPECT_EQ(found.answer, Answer::undecided);
  EXPECT_LT(found.mean.leads().ratio.lower, 0.7);
}

TEST_F(DriveOfTenMinutes, AConservativeFilterIsFound) {
  reference_.covariance.assign(600, 0.01 * Eigen::Matrix3d::Identity());
  for (std::size_t s = 0; s < 600; ++s) {
    reference_.position[s] = {times_[s], 0.0};
    reference_.heading[s] = 0.0;
  }
  EXPECT_THAT(in_words(judged(run(0.05, 0.3))), StartsWith("conservative: NEES "));
}

TEST_F(DriveOfTenMinutes, ManyRunsOnOneDriveSayNoMoreThanOne) {
  const DriveScores one = scores(run(1.0, 0.9));
  const std::vector<DriveScores> many(50, one);
  const DriveConsistency of_one = judge_drive(std::span(&one, 1), 0.95, 1.1);
  const DriveConsistency of_many = judge_drive(many, 0.95, 1.1);
  EXPECT_NEAR(of_many.mean.leads().ratio.lower, of_one.mean.leads().ratio.lower, 1e-12);
  EXPECT_NEAR(of_many.mean.leads().ratio.upper, of_one.mean.leads().ratio.upper, 1e-12);
  EXPECT_NEAR(of_many.minutes, of_one.minutes, 1e-9);
}

TEST_F(DriveOfTenMinutes, AReferenceThatIsTheEstimateIsRefusedAndOneThatFedItPointedOut) {
  RunRows rows = run(1.0, 0.3);
  for (std::size_t s = 0; s < 600; ++s) {
    rows.spread.mean[3 * s] = reference_.position[s].x();
    rows.spread.mean[3 * s + 1] = reference_.position[s].y();
    rows.spread.mean[3 * s + 2] = reference_.heading[s];
  }
  EXPECT_EQ(in_words(judged(rows)), "refused: the reference is this estimate");
  for (std::size_t s = 0; s < 600; ++s) {
    rows.spread.mean[3 * s] += 0.1 * std::sin(7.0 * static_cast<double>(s));
  }
  EXPECT_TRUE(judged(rows).mean.is_below_reference);
  EXPECT_FALSE(judged(run(1.0, 0.3)).mean.is_below_reference);
}

TEST_F(DriveOfTenMinutes, WithoutFixesOrCovarianceIsNotTested) {
  RunRows rows = run(1.0, 0.3);
  rows.spread.covariance.clear();
  EXPECT_EQ(in_words(judged(rows)), "not tested");
  EXPECT_EQ(in_words(judge_drive({}, 0.95, 1.1)), "not tested");
}

TEST_F(DriveOfTenMinutes, ItsTableHasARowForACellAndSaysWhatToConsider) {
  reference_.position[0] = {0.0, 0.0};  // where the drive starts
  RunCriteria criteria = criteria_of_scans(times_);
  criteria.references.emplace_back(reference_, times_, Pose{});
  CellSums sums(criteria);
  MeasuredRun measured;
  measured.rows = run(5.0, 0.3);
  measured.rows.path.spread = measured.rows.spread;
  measured.measure(criteria, 0);
  sums.add(measured);
  StudyAnalysis study;
  study.has_truth = false;
  study.times = times_;
  study.references = {{.name = "reference",
                       .times = times_,
                       .has_heading = true,
                       .has_errors = true,
                       .has_start = criteria.references[0].has_start()}};
  study.cells.emplace_back();
  study.cells.front().label = "mine";
  study.cells.front().filter = "external";
  sums.put(study.cells.front());
  const TextTable table = reported_table(study, "drive");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0][0], "mine");
  EXPECT_THAT(table.rows[0][3], StartsWith("optimistic: NEES "));
  EXPECT_EQ(table.rows[0][8], "600");
  const Section section = reported_section(study, "drive");
  ASSERT_GT(section.blocks.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<Section::Lead>(section.blocks[0]));
  const auto* warnings = std::get_if<Section::Table>(&section.blocks[2]);
  ASSERT_NE(warnings, nullptr);
  EXPECT_EQ(warnings->table.rows.size(), 2U) << "it starts at a fix, and its author is another";
  study.references.front().has_errors = false;
  EXPECT_THAT(reported_table(study, "drive").rows, IsEmpty());
}

TEST_F(DriveOfTenMinutes, AFewGrossOutliersAreCountedAndTheRatioIsSaidWithoutThem) {
  EXPECT_EQ(judged(run(1.0, 0.3)).mean.outliers, 0U);
  const double right = judged(run(1.0, 0.3)).mean.leads().mean;
  EXPECT_DOUBLE_EQ(judged(run(1.0, 0.3)).mean.ratio_without_outliers, right);
  for (const std::size_t fix : {10U, 200U, 201U, 500U}) reference_.position[fix].x() += 300.0;
  const DriveConsistency found = judged(run(1.0, 0.3));
  EXPECT_EQ(found.mean.outliers, 4U);
  EXPECT_GT(found.mean.leads().mean, 50.0 * right);
  EXPECT_NEAR(found.mean.ratio_without_outliers, right, 0.02);
  EXPECT_EQ(found.mean.fixes, 600U) << "the verdict uses all of them";
}

TEST(DriveVerdict, PrintsTheTimeThatItNeedsLikeEveryDuration) {
  DriveConsistency drive;
  drive.answer = Answer::undecided;
  drive.minutes = 5.24e4;
  EXPECT_EQ(in_words(drive), "this drive cannot tell: it would need at least 36.4 d");
  drive.mean.blocks[0].effective_samples = 10.0;
  EXPECT_EQ(in_words(drive), "this drive cannot tell: it would need 36.4 d");
}

// Runs that each met a drive of its own.

/// A drive of `fixes` with one error; its square is `ratio` times the covariance.
DriveScores lasting_errors(std::size_t fixes, double ratio) {
  DriveScores scores;
  scores.median = 1.0;
  scores.fixes = fixes;
  scores.seconds = static_cast<double>(fixes - 1);
  VectorSeries& errors = scores.errors[0];
  for (int c = 0; c < 3; ++c) errors.emplace_back(fixes, std::sqrt(ratio));
  scores.blocks[0] = correlated_average(errors, 0.95);
  return scores;
}

std::vector<DriveScores> drives_with(double ratio, std::size_t count) {
  std::vector<DriveScores> runs;
  for (std::uint64_t k = 0; k < count; ++k) runs.push_back(lasting_errors(50 + 10 * k, ratio));
  return runs;
}

TEST(OwnDrives, OneIsJudgedAsADrive) {
  const auto runs = drives_with(1.0, 1);
  const DriveConsistency own = judge_own_drives(runs, 0.95, 1.1),
                         one = judge_drive(runs, 0.95, 1.1);
  EXPECT_NEAR(own.mean.leads().ratio.lower, one.mean.leads().ratio.lower, 1e-12);
  EXPECT_NEAR(own.mean.leads().ratio.upper, one.mean.leads().ratio.upper, 1e-12);
  EXPECT_EQ(own.answer, one.answer);
}

// Each drive by itself knows one sample, and all together as many as there are drives.
TEST(OwnDrives, ManyFindWhatLastsForAWholeDrive) {
  const auto runs = drives_with(2.5, 20);
  const DriveConsistency own = judge_own_drives(runs, 0.95, 1.1);
  EXPECT_NEAR(own.mean.leads().effective_samples, 20.0, 1e-6);
  EXPECT_EQ(own.answer, Answer::optimistic);
  EXPECT_EQ(own.mean.fixes, 20U * 50U + 10U * 190U);
  EXPECT_EQ(judge_drive(runs, 0.95, 1.1).answer, Answer::undecided) << "were they one drive";
}

TEST(OwnDrives, SayHowManyWouldDecide) {
  const DriveConsistency right = judge_own_drives(drives_with(1.0, 5), 0.95, 1.5);
  ASSERT_EQ(right.answer, Answer::undecided);
  EXPECT_THAT(in_words(right), StartsWith("5 drives cannot tell: it would take "));
  EXPECT_THAT(in_words(right), HasSubstr(" like them"));
}

TEST(OwnDrives, WithoutAJudgedFixAreLeftOut) {
  auto runs = drives_with(1.0, 3);
  const double mean = judge_own_drives(runs, 0.95, 1.1).mean.leads().mean;
  DriveScores none;
  none.in_gaps = 7;
  runs.push_back(none);
  const DriveConsistency found = judge_own_drives(runs, 0.95, 1.1);
  EXPECT_EQ(found.drives, 3U);
  EXPECT_EQ(found.mean.in_gaps, 7U);
  EXPECT_DOUBLE_EQ(found.mean.leads().mean, mean);
  EXPECT_EQ(judge_own_drives({}, 0.95, 1.1).answer, Answer::untested);
}

TEST(OwnDrives, HaveNoMeanOverTime) {
  const std::vector<double> scans = {1.0, 2.0}, others = {0.7, 1.4};
  RunCriteria criteria = criteria_of_scans(scans);
  MeasuredRun run;
  run.times = scans;
  run.rows.ess = run.rows.nis = {2.0, 4.0};
  run.rows.nis_dof = {2, 2};
  const auto analysed = [&] {
    CellSums sums(criteria);
    sums.add(run);
    CellAnalysis cell;
    sums.put(cell);
    return cell;
  };
  EXPECT_THAT(analysed().over_time("ess"), ElementsAre(2.0, 4.0));
  EXPECT_THAT(analysed().get<Innovations>().average, ElementsAre(1.0, 2.0));
  criteria.drives = {{scans, {}, {}}, {others, {}, {}}};
  EXPECT_TRUE(analysed().over_time("ess").empty());
  EXPECT_TRUE(analysed().get<Innovations>().average.empty());
  EXPECT_DOUBLE_EQ(analysed().get<Innovations>().verdict.ratio_estimate(), 1.5)
      << "of whole runs there is one";
  EXPECT_TRUE(series_of(analysed()).empty());
}

const std::vector<double> kScanTimes = {1.0, 2.0, 4.0};

/// The vehicle is at (t, 0) at time t; its variance along x at the scans is as given.
RunRows rows_with(const std::vector<double>& x_variances) {
  RunRows rows;
  for (std::size_t s = 0; s < kScanTimes.size(); ++s) {
    rows.spread.mean.insert(rows.spread.mean.end(), {kScanTimes[s], 0.0, 0.1});
    rows.spread.covariance.insert(rows.spread.covariance.end(),
                                  {x_variances[s], 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5});
  }
  return rows;
}

/// One fix that is `error` off, at `time`, with these variances.
ReferencePath fix_at(double time, const Eigen::Vector3d& error, const Eigen::Vector3d& variances) {
  ReferencePath path{"gps", {time}, {{time - error(0), -error(1)}}, {wrap(0.1 - error(2))}};
  path.covariance = {variances.asDiagonal()};
  return path;
}

FixErrors errors_of(const ReferencePath& path, const RunRows& rows, ErrorBlock block,
                    std::size_t particles = 0) {
  const PathAtFixes fixes(path, kScanTimes, {0.0, 0.0, 0.1});
  RunRows with_path = rows;
  with_path.path.spread = rows.spread;
  return errors_at_fixes(fixes, {}, with_path, particles, block);
}

TEST(FixErrors, AreInUnitsOfBothCovariances) {
  const ReferencePath path = fix_at(1.5, {2.0, 0.0, 0.0}, {2.0, 1.0, 1.0});
  // Halfway between the scans the variance is halfway between 1 and 3.
  const FixErrors position = errors_of(path, rows_with({1.0, 3.0, 1.0}), ErrorBlock::position);
  EXPECT_THAT(position.nees, ElementsAre(DoubleNear(1.0, 1e-12)));
  EXPECT_EQ(position.whitened.size(), 2U);
  EXPECT_THAT(position.whitened[0], ElementsAre(DoubleNear(1.0, 1e-12)));
  EXPECT_THAT(position.by_reference[0], ElementsAre(DoubleNear(std::sqrt(2.0), 1e-12)));
  EXPECT_THAT(position.times, ElementsAre(1.5));
  const FixErrors pose = errors_of(path, rows_with({1.0, 3.0, 1.0}), ErrorBlock::pose);
  EXPECT_THAT(pose.nees, ElementsAre(DoubleNear(1.0, 1e-12)));
}

TEST(FixErrors, KnowTheWholeCovarianceAndTheShorterWayRound) {
  const Eigen::Vector3d error(0.5, -1.0, 0.4);
  ReferencePath path = fix_at(2.0, error, {1e-20, 1e-20, 1e-20});
  Eigen::Matrix3d P;
  P << 3.0, 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5;
  const RunRows rows = rows_with({1.0, 3.0, 1.0});
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::pose).nees[0], nees<3>(error, P).value, 1e-9);
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::heading).nees[0], 0.16 / 0.5, 1e-9);
  path.heading[0] += kTwoPi;
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::heading).nees[0], 0.16 / 0.5, 1e-9);
}

TEST(FixErrors, LeaveOutAndCountWhatCannotBeJudged) {
  const RunRows rows = rows_with({1.0, 1.0, 1.0});
  const ReferencePath in_gap = fix_at(3.0, {1, 1, 1}, {1, 1, 1});
  EXPECT_THAT(errors_of(in_gap, rows, ErrorBlock::pose).nees, IsEmpty());
  EXPECT_EQ(drive_scores(PathAtFixes(in_gap, kScanTimes, {}), {}, rows, 0, 0.95).in_gaps, 1U);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const FixErrors undefined =
      errors_of(fix_at(1.5, {1, 1, 1}, {1, 1, 1}), rows_with({1.0, nan, 1.0}), ErrorBlock::pose);
  EXPECT_EQ(undefined.undefined, 1U);
  const FixErrors indefinite =
      errors_of(fix_at(2.0, {1, 1, 1}, {1, 1, 1}), rows_with({1.0, -9.0, 1.0}), ErrorBlock::pose);
  EXPECT_EQ(indefinite.undefined, 1U);
  EXPECT_EQ(errors_of(fix_at(0.5, {1, 1, 1}, {1, 1, 1}), rows, ErrorBlock::pose).nees.size(), 1U);
}

TEST(FixErrors, BeginAtTheCovarianceThatFiltersAreGiven) {
  const ReferencePath path = fix_at(0.0, {2.0, 0.0, 0.0}, {1e-20, 1e-20, 1e-20});
  const PathAtFixes fixes(path, kScanTimes, {}, 4.0 * Eigen::Matrix3d::Identity());
  RunRows rows = rows_with({1.0, 1.0, 1.0});
  rows.path.spread = rows.spread;
  EXPECT_THAT(errors_at_fixes(fixes, {}, rows, 0, ErrorBlock::position).nees,
              ElementsAre(DoubleNear(1.0, 1e-12)));
}

TEST(FixErrors, AreNoneWithoutCovarianceOrHeading) {
  ReferencePath path = fix_at(1.5, {1, 1, 1}, {1, 1, 1});
  RunRows rows = rows_with({1.0, 1.0, 1.0});
  path.heading.clear();
  EXPECT_THAT(errors_of(path, rows, ErrorBlock::pose).nees, IsEmpty());
  EXPECT_EQ(errors_of(path, rows, ErrorBlock::position).nees.size(), 1U);
  rows.spread.covariance.clear();
  EXPECT_THAT(errors_of(path, rows, ErrorBlock::position).nees, IsEmpty());
}

// With an exact reference drawn poses are judged as where the truth is known, with a coarse one as
// a Gaussian.
TEST(FixErrors, OfDrawnPosesGoFromTheOneScaleToTheOther) {
  const Eigen::Vector3d error(2.0, 2.0, 1.0);
  Eigen::Matrix3d P;
  P << 3.0, 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5;
  const RunRows rows = rows_with({1.0, 3.0, 1.0});
  const EffectiveDraws draws = effective_draws(20, 20.0);
  const double exact =
      errors_of(fix_at(2.0, error, {1e-20, 1e-20, 1e-20}), rows, ErrorBlock::pose, 20).nees[0];
  EXPECT_NEAR(exact, SamplerScale(3)(nees<3>(error, P).value, draws), 1e-6);
  EXPECT_LT(exact, nees<3>(error, P).value);
  const double coarse =
      errors_of(fix_at(2.0, error, {1e4, 1e4, 1e4}), rows, ErrorBlock::pose, 20).nees[0];
  EXPECT_NEAR(coarse, 9.0 / 1e4, 1e-6);
  EXPECT_EQ(errors_of(fix_at(2.0, error, {1, 1, 1}), rows, ErrorBlock::pose, 5).undefined, 1U)
      << "five draws cannot be judged";
}

// Between scans particles keep their weights, so that the last scan says how many draws they are.
TEST(FixErrors, BetweenScansUseTheDrawsOfTheLastScan) {
  RunRows rows = rows_with({1.0, 3.0, 1.0});
  rows.path.spread = rows.spread;
  rows.ess = {20.0};
  const std::vector<std::uint32_t> scan_rows = {1};  // rows 0 and 2 are steps without a scan
  const auto nees_at = [&](double time, std::size_t particles) {
    const ReferencePath path = fix_at(time, {2.0, 2.0, 1.0}, {1e-20, 1e-20, 1e-20});
    return errors_at_fixes(PathAtFixes(path, kScanTimes, {}), scan_rows, rows, particles,
                           ErrorBlock::pose)
        .nees[0];
  };
  const Eigen::Vector3d error(2.0, 2.0, 1.0);
  Eigen::Matrix3d P;
  P << 1.0, 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5;
  const double nees_of_error = nees<3>(error, P).value;
  EXPECT_NEAR(nees_at(1.0, 200), SamplerScale(3)(nees_of_error, effective_draws(200, 200.0)), 1e-6);
  EXPECT_NEAR(nees_at(4.0, 200), SamplerScale(3)(nees_of_error, effective_draws(200, 20.0)), 1e-6);
}

ReferencePath reference_at(const std::vector<double>& times) {
  ReferencePath path{"gps", times, {}, {}};
  for (const double time : times) {
    path.position.emplace_back(time, 0.0);
    path.heading.push_back(0.1);
  }
  return path;
}

const std::vector<double> kRowTimes = {1.0, 2.0, 3.0};
constexpr Pose kStart{-10.0, 0.0, 0.0};
const std::vector<double> kPathRows = {0.0, 10.0, 0.5,  // row by row
                                       2.0, 10.0, 1.0,  //
                                       6.0, 30.0, 2.0};

TEST(PathAtFixes, UsesOnlyFixesWithinTheDrive) {
  const PathAtFixes fixes(reference_at({-0.1, 0.0, 2.5, 3.0, 3.1}), kRowTimes, kStart);
  EXPECT_THAT(fixes.times(), ElementsAre(0.0, 2.5, 3.0));
  EXPECT_EQ(fixes.positions()[1], Eigen::Vector2d(2.5, 0.0));
  EXPECT_EQ(fixes.headings().size(), 3u);
  EXPECT_EQ(fixes.interpolate(kPathRows).size(), 3u);
  EXPECT_EQ(fixes.in_gaps(), 0U);
  EXPECT_EQ(fixes.outside(), 2U) << "those at -0.1 and 3.1 s";
}

// No number counts what is interpolated across a gap, but a fix beside a gap is judged.
TEST(PathAtFixes, UsesFixesInGapsOnlyWhereAPoseIsStored) {
  const std::vector<double> times = {2.0, 5.0, 6.0 + 5e-10, 9.0};
  const PathAtFixes fixes(reference_at({0.0, 0.5, 2.0, 2.0005, 3.5, 4.998, 4.9995, 5.4, 6.1, 9.0}),
                          times, kStart);
  EXPECT_THAT(fixes.times(), ElementsAre(0.0, 2.0, 2.0005, 4.9995, 5.4, 9.0));
  EXPECT_EQ(fixes.in_gaps(), 4U);
}

TEST(PathAtFixes, KnowWhetherTheDriveStartsAtAFixThatIsNotJudged) {
  const std::vector<double> times = {5.0};
  ReferencePath reference = reference_at({0.5, 2.0});
  reference.position[0] = {kStart.x, kStart.y};
  const PathAtFixes fixes(reference, times, kStart);
  EXPECT_EQ(fixes.in_gaps(), 2U);
  EXPECT_TRUE(fixes.has_start());
}

TEST(PathAtFixes, GoesLinearlyInTimeBetweenRowsAndFromTheStart) {
  const PathAtFixes fixes(reference_at({0.0, 0.25, 1.0, 1.5, 2.5, 3.0}), kRowTimes, kStart);
  const std::vector<Pose> poses = fixes.interpolate(kPathRows);
  const double x[] = {-10.0, -7.5, 0.0, 1.0, 4.0, 6.0};
  const double y[] = {0.0, 2.5, 10.0, 10.0, 20.0, 30.0};
  const double heading[] = {0.0, 0.125, 0.5, 0.75, 1.5, 2.0};
  for (std::size_t f = 0; f < poses.size(); ++f) {
    EXPECT_DOUBLE_EQ(poses[f].x, x[f]) << f;
    EXPECT_DOUBLE_EQ(poses[f].y, y[f]) << f;
    EXPECT_DOUBLE_EQ(poses[f].heading, heading[f]) << f;
  }
}

TEST(PathAtFixes, TurnsTheShorterWayAcrossPi) {
  const std::vector<double> times = {0.0, 1.0};
  const PathAtFixes fixes(reference_at({0.25, 0.75}), times, {});
  const auto poses = fixes.interpolate(std::vector{0.0, 0.0, kPi - 0.1, 0.0, 0.0, -kPi + 0.1});
  EXPECT_NEAR(poses[0].heading, kPi - 0.05, 1e-12);
  EXPECT_NEAR(poses[1].heading, -kPi + 0.05, 1e-12);
}

TEST(PathAtFixes, TakesTheFirstRowWhereItLiesAtTheStartsTime) {
  const std::vector<double> times = {0.0, 1.0};
  const PathAtFixes fixes(reference_at({0.0}), times, kStart);
  EXPECT_EQ(fixes.interpolate(std::vector(6, 7.0))[0].x, 7.0);
}

}  // namespace
}  // namespace montecarta::analysis
