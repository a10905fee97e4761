// SPDX-License-Identifier: BSD-3-Clause
// Truths that are moved onto first estimates: who is accused, whatever errors remember.
#include "experiments/judging/anchored_runs.hpp"

#include "analysis/study/imported_notes.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/judged_study.hpp"
#include "tests/analysis/verdict_studies.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <iostream>
#include <utility>

namespace montecarta::experiments {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

const StateShape kPoses = {
    StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};
constexpr std::size_t kEstimates = 61, kRunsOfAStudy = 20;

/// A dependence of errors in the map, of covariances that an estimator would report.
struct ErrorLaw {
  std::string name;
  double start = 1.0;       ///< deviations of the first estimate, in units of kDeviations
  double walk = 0.0;        ///< those of a step of a random walk
  double remembers = -1.0;  ///< share of an error that lasts to the next; below 0: a random walk
  double growth = 0.0;      ///< of the variance per step, if errors are no random walk
  /// Of y and heading of errors that are no random walk, after a start with the deviations
  /// `start`: only a narrow direction of their covariance is as small as that of the start.
  double correlation = 0.0;
};
const Vector3d kDeviations(0.05, 0.04, 0.004);
const std::vector<ErrorLaw> kLaws = {
    {.name = "known start, random walk", .start = 0.0, .walk = 0.2},
    {.name = "start nearly known, random walk", .start = 1e-3, .walk = 0.2},
    {.name = "uncertain start, random walk", .walk = 0.2},
    {.name = "uncertain start that persists", .walk = 0.001},
    {.name = "errors forget within 2 estimates", .remembers = 0.5},
    {.name = "errors forget within 40 estimates", .remembers = 0.975},
    {.name = "errors forget, variances grow", .remembers = 0.9, .growth = 0.05},
    {.name = "errors forget, correlated", .start = 0.02, .remembers = 0.0, .correlation = 0.9999}};

Vector3d true_pose(std::size_t k) {
  const double angle = 0.1 * static_cast<double>(k);
  return {5.0 * std::cos(angle), 5.0 * std::sin(angle), wrap(angle + kPi / 2)};
}

/// The motion of the pose at `k` by small errors of the first pose, which it carries along.
Matrix3d carried(std::size_t k) {
  const Vector3d way = true_pose(k) - true_pose(0);
  Matrix3d found = Matrix3d::Identity();
  found(0, 2) = -way.y();
  found(1, 2) = way.x();
  return found;
}

/// Runs whose errors are `scale` times as large as they claim.
class DrawnRuns final : public EstimateSource {
 public:
  DrawnRuns(std::vector<ErrorLaw> laws, double scale, std::uint64_t study)
      : laws_(std::move(laws)), scale_(scale), study_(study) {
    for (std::size_t c = 0; c < laws_.size(); ++c) cells_.push_back("mine" + std::to_string(c));
    for (std::uint64_t run = 0; run < kRunsOfAStudy; ++run) runs_.push_back(run);
  }
  /// Gives the first `runs` of each cell another law.
  void except(std::size_t runs, const ErrorLaw& law) {
    exceptions_ = runs;
    exception_ = law;
  }
  const std::vector<std::string>& cells() const override { return cells_; }
  const std::vector<std::uint64_t>& runs() const override { return runs_; }
  std::filesystem::path place(std::size_t /*cell*/, std::size_t run) const override {
    return "run_" + std::to_string(run);
  }
  std::filesystem::path truth_place(std::size_t /*cell*/, std::size_t /*run*/) const override {
    return "truth";
  }
  std::vector<double> times(std::size_t cell, std::size_t run) const override {
    return estimates(cell, run).time;
  }
  bool has_common_truths() const override { return true; }
  bool has_errors() const override { return false; }
  TextPairs contents() const override { return {}; }
  std::vector<std::string> notes() const override { return {}; }

  StateRows truth(std::size_t /*cell*/, std::size_t /*run*/,
                  const StateShape& shape) const override {
    StateRows rows{.shape = shape};
    for (std::size_t k = 0; k < kEstimates; ++k) add(true_pose(k), rows);
    return rows;
  }
  StateRows estimates(std::size_t cell, std::size_t run) const override {
    const ErrorLaw& law = run < exceptions_ ? exception_ : laws_[cell];
    RngStream draw({study_, run, 0, 0, Draw::test});
    const auto normal = [&] {
      Vector3d drawn;
      for (double& value : drawn) value = draw.normal();
      return Vector3d(drawn.cwiseProduct(kDeviations));
    };
    StateRows rows{.shape = kPoses};
    Vector3d start = law.start * normal(), error = start;
    for (std::size_t k = 0; k < kEstimates; ++k) {
      const auto steps = static_cast<double>(k);
      Matrix3d P = kDeviations.cwiseAbs2().asDiagonal();
      Vector3d at_k = error;
      if (law.remembers < 0.0) {
        at_k += carried(k) * start - start;
        const Matrix3d of_start = law.start * law.start * P;
        P *= law.walk * law.walk * steps;
        P += carried(k) * of_start * carried(k).transpose();
        error += law.walk * normal();
      } else {
        if (k == 0 && law.correlation > 0.0) {
          P *= law.start * law.start;
        } else {
          P(1, 2) = P(2, 1) = law.correlation * kDeviations(1) * kDeviations(2);
          const double independent = std::sqrt(1.0 - law.correlation * law.correlation);
          at_k(2) = kDeviations(2) * (law.correlation * at_k(1) / kDeviations(1) +
                                      independent * at_k(2) / kDeviations(2));
        }
        P *= 1.0 + law.growth * steps;
        at_k *= std::sqrt(1.0 + law.growth * steps);
        error = law.remembers * error + std::sqrt(1.0 - law.remembers * law.remembers) * normal();
      }
      add(true_pose(k) + scale_ * at_k, rows);
      rows.covariance.emplace_back(0.5 * (P + P.transpose()));
    }
    return rows;
  }

 private:
  static void add(const Vector3d& pose, StateRows& rows) {
    rows.time.push_back(static_cast<double>(rows.time.size()));
    rows.line.push_back(rows.line.size() + 2);
    rows.state.emplace_back(pose);
  }

  std::vector<ErrorLaw> laws_;  ///< {cell}
  double scale_;
  std::uint64_t study_;
  std::size_t exceptions_ = 0;
  ErrorLaw exception_;
  std::vector<std::string> cells_;
  std::vector<std::uint64_t> runs_;
};

/// The verdict on a study with the anchor yaw, and the notes on it.
struct Anchored {
  analysis::Verdict verdict;
  std::vector<std::string> notes;
  std::vector<std::string> of_result;  ///< those that the tables have
};

Anchored anchored(const DrawnRuns& runs, std::size_t cell = 0) {
  const ScratchFolder folder;
  JudgingOptions options;
  options.output = folder / "mine.h5";
  options.convention = ErrorConvention::world;
  options.anchor = Anchor::yaw;
  Anchored found;
  found.notes = judge_estimates(runs, options);
  const analysis::StudyAnalysis analysed = analysis::analyze(ResultFile(options.output));
  found.verdict = analysed.cells[cell].verdict;
  found.of_result = analysis::imported_notes(analysed);
  return found;
}

Anchored anchored(const ErrorLaw& law, double scale, std::uint64_t study) {
  return anchored(DrawnRuns({law}, scale, study));
}

TEST(AnchoredRuns, BoundTheErrorsOfUncertainAnchors) {
  const auto is_bounded = [](const ErrorLaw& law) {
    return anchored(law, 1.0, 1).verdict.is_by_upper_bounds;
  };
  EXPECT_FALSE(is_bounded(kLaws[0])) << "a start that is known exactly";
  EXPECT_FALSE(is_bounded(kLaws[1]));
  for (std::size_t k = 2; k < kLaws.size(); ++k) EXPECT_TRUE(is_bounded(kLaws[k])) << kLaws[k].name;
  EXPECT_THAT(anchored(kLaws[0], 1.0, 1).notes, testing::IsEmpty());
  EXPECT_THAT(anchored(kLaws[2], 1.0, 1).notes,
              testing::ElementsAre(AllOf(HasSubstr("0.05 m of x in run_0"), HasSubstr("bound"))));
}

// The row of a block in a table has its answer alone.
TEST(ImportedNotes, SayWhyBlocksAreUndecided) {
  EXPECT_THAT(anchored(kLaws[0], 1.0, 1).of_result,
              testing::Contains(AllOf(HasSubstr("mine0, position by itself: undecided: about "),
                                      HasSubstr(" more runs decide"))));
}

TEST(AnchoredRuns, LeaveOutEstimatesSoonAfterTheAnchor) {
  const ErrorLaw law = {.name = "", .start = 0.01, .walk = 0.2};  // 1 + k / 400 to 1
  const Anchored found = anchored(law, 1.0, 1);
  EXPECT_FALSE(found.verdict.is_by_upper_bounds);
  EXPECT_EQ(found.verdict.missing, 2 * kRunsOfAStudy);
  EXPECT_THAT(found.notes, testing::ElementsAre(HasSubstr("40 estimates are left out soon after")));
}

// A start that is uncertain beside a few estimates, or in a few runs, is that of its cell and run.
TEST(AnchoredRuns, AreJudgedByCellAndRun) {
  const DrawnRuns both({kLaws[0], kLaws[2]}, 1.0, 1);
  const Anchored known = anchored(both, 0), uncertain = anchored(both, 1);
  EXPECT_FALSE(known.verdict.is_by_upper_bounds);
  EXPECT_TRUE(uncertain.verdict.is_by_upper_bounds);
  EXPECT_EQ(uncertain.verdict.missing, 0U);
  EXPECT_THAT(known.notes, testing::ElementsAre(HasSubstr("mine1: first estimates")));
  EXPECT_THAT(known.of_result, testing::Contains(HasSubstr("The first estimates of mine1 have")));
  EXPECT_THAT(known.of_result, testing::Contains(HasSubstr("mine0, position by itself")));
  DrawnRuns with_one({kLaws[0]}, 1.0, 1);
  with_one.except(1, kLaws[3]);
  const Anchored one = anchored(with_one);
  EXPECT_TRUE(one.verdict.is_by_upper_bounds);
  EXPECT_EQ(one.verdict.missing, 0U) << "no estimate of this run is left out";
}

// Law: consistent estimators are accused in at most 5 % of studies, whatever their errors remember,
// and plainly optimistic ones are found, unless all of their error is that of the anchor.
// `MONTECARTA_STUDIES=1000` draws more studies.
TEST(AnchoredRunsSlow, AccuseNoConsistentEstimator) {
  const std::uint64_t studies = analysis::studies_of_a_line(40);
  for (const ErrorLaw& law : kLaws) {
    const auto share = [&](double scale) {
      return analysis::share_of_studies(studies, [&](std::uint64_t study) {
        return anchored(law, scale, study).verdict.has_finding();
      });
    };
    const double accused = share(1.0), found = share(3.0);
    EXPECT_LE(accused, 0.05 + analysis::share_errors(0.05, studies)) << law.name;
    const bool is_all_of_anchor = law.walk > 0.0 && law.walk < 0.01;
    if (is_all_of_anchor) {
      EXPECT_LT(found, 0.5) << law.name;
    } else {
      EXPECT_GT(found, 0.6) << law.name;
    }
    std::cout << law.name << ": of " << studies << " studies, " << accused
              << " of consistent ones are accused, and " << found
              << " of those whose errors are 3 times too large\n";
  }
}

}  // namespace
}  // namespace montecarta::experiments
