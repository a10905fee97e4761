// SPDX-License-Identifier: BSD-3-Clause
// Position, rotation and velocity of imported states are judged by themselves.
#include "analysis/verdict/block_errors.hpp"

#include "analysis/run/nees.hpp"
#include "tests/analysis/verdict_studies.hpp"
#include "tests/doubles/matchers.hpp"

#include <Eigen/Cholesky>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Names = std::vector<std::string>;

TEST(StateBlocks, AreFoundByNameAndUnit) {
  const auto names_of = [](const Names& components, const Names& units) {
    std::vector<std::string> names;
    for (const StateBlock& block : blocks_of(components, units)) names.push_back(block.name);
    return names;
  };
  EXPECT_THAT(names_of({"x", "y", "heading"}, {"m", "m", "rad"}),
              ElementsAre("position", "heading"));
  EXPECT_THAT(names_of({"x", "y", "rz"}, {"m", "m", "rad"}), ElementsAre("position", "rotation"));
  EXPECT_THAT(names_of({"x", "vx", "bias"}, {"m", "mps", ""}), ElementsAre("position", "velocity"));
  EXPECT_THAT(names_of({"x", "y"}, {"m", "m"}), IsEmpty()) << "the whole state";
  EXPECT_THAT(names_of({"x", "y", "e"}, {"", "", ""}), IsEmpty()) << "of unknown units";
  const Names components = {"b", "y", "x"}, units = {"m", "m", "m"};
  EXPECT_THAT(blocks_of(components, units).front().components, ElementsAre(1, 2));
}

/// Errors of four components at 40 scans with a full covariance; those of the last two are `factor`
/// times as large as it says.
ErrorRows errors_of_run(std::uint64_t run, double factor) {
  RngStream draw({19, run, 0, 0, Draw::test});
  Eigen::Matrix4d P = 0.3 * Eigen::Matrix4d::Ones();
  P.diagonal() << 1.0, 2.0, 0.5, 1.5;
  const Eigen::Matrix4d root = P.llt().matrixL();
  ErrorRows rows;
  for (int scan = 0; scan < 40; ++scan) {
    Eigen::Vector4d error;
    for (double& one : error) one = draw.normal();
    error = root * error;
    error.tail<2>() *= factor;
    rows.value.insert(rows.value.end(), error.begin(), error.end());
    rows.covariance.insert(rows.covariance.end(), P.data(), P.data() + 16);
  }
  return rows;
}

class BlocksOfAState : public testing::Test {
 protected:
  std::vector<BlockVerdict> judged(double factor) {
    BlockErrors sums(blocks_, 40);
    for (std::uint64_t run = 0; run < 50; ++run) sums.add(errors_of_run(run, factor), run, blocks_);
    return sums.result(blocks_, {names_, times_}, 0.95, 1.5, 50);
  }
  std::vector<StateBlock> blocks_ = {{"position", {0, 1}}, {"velocity", {2, 3}}};
  Names names_ = {"x", "y", "vx", "vy"};
  std::vector<double> times_ = std::vector<double>(40, 0.0);
};

TEST_F(BlocksOfAState, AreJudgedByThemselves) {
  const auto right = judged(1.0), wrong = judged(1.4);
  EXPECT_EQ(right[0].verdict.answer, Answer::consistent);
  EXPECT_EQ(wrong[0].verdict.answer, Answer::consistent) << "it does not see the other block";
  EXPECT_EQ(wrong[0].verdict.ratio_estimate(), right[0].verdict.ratio_estimate());
  EXPECT_EQ(right[1].verdict.answer, Answer::consistent);
  EXPECT_EQ(wrong[1].verdict.answer, Answer::optimistic);
  EXPECT_NEAR(wrong[1].verdict.ratio_estimate(), 1.4 * 1.4 * right[1].verdict.ratio_estimate(),
              1e-12);
  EXPECT_EQ(wrong[1].verdict.level, 0.975) << "both blocks together have 0.95";
}

TEST_F(BlocksOfAState, HaveTheNeesOfTheirBlockOfTheCovariance) {
  double sum = 0.0;
  for (std::uint64_t run = 0; run < 50; ++run) {
    const ErrorRows rows = errors_of_run(run, 1.0);
    for (std::size_t s = 0; s < rows.scans(); ++s) {
      const Eigen::Vector2d e = rows.error(s).tail<2>();
      const Eigen::Matrix2d P = rows.covariance_of(s).bottomRightCorner<2, 2>();
      sum += e.dot(P.llt().solve(e)) / 2.0;
    }
  }
  EXPECT_NEAR(judged(1.0)[1].verdict.ratio_estimate(), sum / (50.0 * 40.0), 1e-12);
}

TEST_F(BlocksOfAState, LeaveOutWhatTheWholeLeavesOut) {
  BlockErrors sums(blocks_, 40);
  ErrorRows rows = errors_of_run(0, 1.0);
  rows.covariance[0] = -1.0;  // of x: no covariance matrix
  rows.value[2] = 1e6;        // the error of vx at the same scan
  sums.add(rows, 0, blocks_);
  const auto found = sums.result(blocks_, {names_, times_}, 0.95, 1.3, 1);
  for (const BlockVerdict& block : found) {
    EXPECT_LT(block.verdict.ratio_estimate(), 10.0) << block.name;
  }
}

}  // namespace
}  // namespace montecarta::analysis
