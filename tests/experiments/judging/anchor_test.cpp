// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/anchor.hpp"

#include "engine/numbers/angle.hpp"
#include "experiments/judging/error_convention.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

#include <Eigen/Geometry>

namespace montecarta::experiments {
namespace {

const StateShape kPlane = {
    StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};
const StateShape kSpace = {
    StateKind::pose_in_space,
    {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "vx_mps", "vy_mps", "vz_mps"},
    {"x", "y", "z", "rx", "ry", "rz", "vx", "vy", "vz"},
    {"m", "m", "m", "rad", "rad", "rad", "mps", "mps", "mps"}};

/// A state that stands at `p`, rotated by `turn`, with the velocity (1, 0, 0) of its own frame.
Eigen::VectorXd state_in_space(const Eigen::Vector3d& p, const Eigen::Quaterniond& turn) {
  Eigen::VectorXd state(10);
  state << p, turn.coeffs(), turn * Eigen::Vector3d::UnitX();
  return state;
}

Eigen::Quaterniond turn_about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// Truths, and estimates that are the same path seen from another frame, `turn` and `shift`.
struct Seen {
  StateRows estimates;
  std::vector<std::optional<TrueState>> truths;
};

Seen seen_from(const Eigen::Quaterniond& turn, const Eigen::Vector3d& shift) {
  Seen seen{.estimates = {.shape = kSpace}, .truths = {}};
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d p(3.0 + k, -2.0 * k, 0.1 * k);
    const Eigen::Quaterniond q = turn_about({0.2, 0.1 * k, 1.0}, 0.3 * k + 0.2);
    seen.truths.emplace_back(TrueState{state_in_space(p, q)});
    seen.estimates.time.push_back(k);
    seen.estimates.state.push_back(state_in_space(turn * p + shift, turn * q));
  }
  return seen;
}

double largest_error(const Seen& seen) {
  double most = 0.0;
  for (std::size_t k = 0; k < seen.truths.size(); ++k) {
    if (!seen.truths[k]) continue;
    most = std::max(most, error_of(kSpace, ErrorConvention::world, seen.estimates.state[k],
                                   seen.truths[k]->state)
                              .norm());
  }
  return most;
}

// Law: a path seen from another frame has no error once its truth is moved by that much, and has
// one if the truth is moved by less.
TEST(Anchor, UndoesTheFrameThatItNames) {
  const Eigen::Vector3d shift(5.0, -7.0, 2.0), vertical = Eigen::Vector3d::UnitZ();
  const Eigen::Quaterniond yaw = turn_about(vertical, 2.5), any = turn_about({1, 2, 3}, 1.0);
  const auto after = [&](Anchor anchor, const Eigen::Quaterniond& turn) {
    Seen seen = seen_from(turn, shift);
    move_to_anchor(anchor, seen.estimates, "e.csv", seen.truths);
    EXPECT_FALSE(seen.truths.front()) << "the anchor has no error by definition";
    EXPECT_TRUE(seen.truths.back());
    return largest_error(seen);
  };
  EXPECT_LT(after(Anchor::first, Eigen::Quaterniond::Identity()), 1e-12);
  EXPECT_LT(after(Anchor::yaw, yaw), 1e-12);
  EXPECT_LT(after(Anchor::se3, any), 1e-12);
  EXPECT_GT(after(Anchor::first, yaw), 1.0);
  EXPECT_GT(after(Anchor::yaw, any), 0.5);
}

TEST(Anchor, TurnsAPoseInThePlane) {
  StateRows estimates{.shape = kPlane, .time = {0, 1, 2}, .state = {}};
  std::vector<std::optional<TrueState>> truths = {std::nullopt};
  estimates.state = {Eigen::Vector3d(9, 9, 9), Eigen::Vector3d(1, 2, kPi / 2),
                     Eigen::Vector3d(1, 3, kPi)};
  truths.emplace_back(TrueState{Eigen::Vector3d(0, 0, 0)});
  truths.emplace_back(TrueState{Eigen::Vector3d(1, 0, kPi / 2)});
  move_to_anchor(Anchor::yaw, estimates, "e.csv", truths);
  EXPECT_FALSE(truths[1]) << "the first estimate that has a truth is the anchor";
  EXPECT_LT((truths[2]->state - Eigen::Vector3d(1, 3, kPi)).norm(), 1e-12);
}

TEST(Anchor, IsForPoses) {
  const StateRows vector{.shape = {StateKind::vector, {"a"}, {"a"}, {"1"}}};
  std::vector<std::optional<TrueState>> none;
  EXPECT_THAT(complaint_of([&] { move_to_anchor(Anchor::first, vector, "e.csv", none); }),
              HasSubstr("e.csv: --anchor first is for poses"));
}

/// The truth of an estimate with this error (position, then rotation) by a convention.
Eigen::VectorXd truth_with_error(const Eigen::VectorXd& mean, const Eigen::VectorXd& error,
                                 ErrorConvention convention) {
  const Eigen::Quaterniond R = quaternion_in(mean);
  const Eigen::Vector3d turn = error.segment<3>(3), shift = error.head<3>();
  const Eigen::Quaterniond back = turn_about(turn, -turn.norm());
  const bool is_body = convention == ErrorConvention::body;
  Eigen::VectorXd truth = mean;
  truth.head<3>() -= is_body ? Eigen::Vector3d(R * shift) : shift;
  truth.segment<4>(kQuaternionPlace) =
      (is_body || convention == ErrorConvention::world_body ? R * back : back * R).coeffs();
  return truth;
}

// Law: an anchor with the error v puts the error into a later estimate whose covariance is that of
// the motion by v, with the lever of the distance between both.
TEST(Anchor, CarriesItsErrorIntoLaterEstimates) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(9);
  error.head<6>() << 2e-4, -1e-4, 3e-4, 1e-4, 2e-4, -1.5e-4;
  for (const ErrorConvention convention :
       {ErrorConvention::world, ErrorConvention::body, ErrorConvention::world_body}) {
    for (const Anchor anchor : {Anchor::first, Anchor::yaw, Anchor::se3}) {
      Seen seen = seen_from(Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
      seen.estimates.covariance.assign(4, error * error.transpose());
      const AnchorError of_anchor(anchor, convention, seen.estimates, 0);
      ASSERT_FALSE(of_anchor.is_known());
      seen.truths[0]->state = truth_with_error(seen.estimates.state[0], error, convention);
      move_to_anchor(anchor, seen.estimates, "e.csv", seen.truths);
      for (std::size_t row = 1; row < 4; ++row) {
        const Eigen::VectorXd carried =
            error_of(kSpace, convention, seen.estimates.state[row], seen.truths[row]->state);
        const Eigen::MatrixXd expected = carried * carried.transpose();
        EXPECT_LT((of_anchor.covariance_in(row) - expected).norm(), 2e-3 * expected.norm())
            << name_of(convention) << ", " << name_of(anchor) << ", row " << row;
      }
    }
  }
}

TEST(Anchor, IsKnownWhereWhatItMovesIs) {
  Seen seen = seen_from(Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
  Eigen::VectorXd variances = Eigen::VectorXd::Ones(9);
  variances.head<3>().setConstant(1e-13);
  seen.estimates.covariance.assign(4, variances.asDiagonal());
  const auto is_known = [&](Anchor anchor) {
    return AnchorError(anchor, ErrorConvention::world, seen.estimates, 0).is_known();
  };
  EXPECT_TRUE(is_known(Anchor::first));
  EXPECT_FALSE(is_known(Anchor::yaw));
}

}  // namespace
}  // namespace montecarta::experiments
