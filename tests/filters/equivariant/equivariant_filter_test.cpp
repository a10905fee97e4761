// SPDX-License-Identifier: BSD-3-Clause
// The equivariant filter equals the one that is written down here with complex numbers and full
// matrices, moved at every control step, its error of the pose in the axes of the vehicle.
#include "filters/equivariant/equivariant_filter.hpp"

#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <vector>

namespace montecarta::filters {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI{0.0, 1.0};

Eigen::Matrix2d times(Complex factor) {
  return Eigen::Matrix2d{{factor.real(), -factor.imag()}, {factor.imag(), factor.real()}};
}
Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B; }

/// V of the exponential of SE(2) as a complex number.
Complex chord(double turn) {
  return std::abs(turn) < 1e-9 ? 1.0 + 0.5 * kI * turn
                               : (std::polar(1.0, turn) - 1.0) / (kI * turn);
}

/// The derivative of exp(-x) U exp(x') with respect to x': Ad of U.
Eigen::Matrix3d adjoint(Complex way, double turn) {
  Eigen::Matrix3d Ad = Eigen::Matrix3d::Identity();
  Ad.topLeftCorner<2, 2>() = times(std::polar(1.0, turn));
  const Complex arm = -kI * way;
  Ad(0, 2) = arm.real();
  Ad(1, 2) = arm.imag();
  return Ad;
}

/// A car with its noise on the controls, and known association.
class Literal {
 public:
  explicit Literal(const SmallWorldSettings& settings) : belief_(settings.noise) {}

  void start(const Pose& pose) {
    place_ = {pose.x, pose.y};
    heading_ = pose.heading;
    P_ = Eigen::Matrix3d::Zero();
    landmarks_.clear();
    slots_.clear();
  }

  void predict(const StepContext&, const Control& u, double duration) {
    const double L = std::get<Car>(belief_.vehicle).wheelbase;
    const Complex direction = std::polar(1.0, u[1]);
    const double length = u[0] * duration, turn = length * std::sin(u[1]) / L;
    const Complex way = length * direction, back = std::polar(1.0, -turn);
    Eigen::Matrix<double, 3, 2> G;  // error of the pose in its own axes, by those of the controls
    const Complex by_speed = back * direction * duration, by_steer = back * kI * way;
    G << by_speed.real(), by_steer.real(), by_speed.imag(), by_steer.imag(),
        duration * std::sin(u[1]) / L, length * std::cos(u[1]) / L;
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(P_.rows(), P_.rows());
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(P_.rows(), 3);
    F.topLeftCorner<3, 3>() = adjoint(-back * way, -turn);
    N.topRows<3>() = -Eigen::Matrix3d::Identity();
    for (std::size_t k = 0; k < landmarks_.size(); ++k) {
      const Complex before = landmarks_[k], after = back * (before - way);
      F.block<2, 2>(row_of(k), row_of(k)) = times(before / (before - way));
      N.block<2, 2>(row_of(k), 0) = -times(1.0 / after);
      N(row_of(k) + 1, 2) = -1.0;
      landmarks_[k] = after;
    }
    const auto& sigma = belief_.control.sigma;
    const Eigen::Matrix2d Q = Eigen::Vector2d(sigma[0], sigma[1]).cwiseAbs2().asDiagonal();
    const Eigen::MatrixXd NG = product(N, G);
    P_ = product(product(F, P_), F.transpose()) + product(product(NG, Q), NG.transpose());
    place_ += std::polar(1.0, heading_) * way;
    heading_ += turn;
  }

  void update(const StepContext&, Scan scan) {
    log_likelihood = nis = 0.0;
    const auto known = slots_;
    for (const Detection& z : scan) {
      if (known.contains(z.identity)) use(z, known.at(z.identity));
    }
    for (const Detection& z : scan) {
      if (!known.contains(z.identity)) append(z);
    }
  }

  PoseMoments moments() const {
    Eigen::Matrix3d A = -Eigen::Matrix3d::Identity();
    A.topLeftCorner<2, 2>() = -times(std::polar(1.0, heading_));
    return {{place_.real(), place_.imag(), wrap(heading_)},
            A * P_.topLeftCorner<3, 3>() * A.transpose()};
  }
  LandmarkEstimate landmark(std::int32_t identity) const {
    const std::size_t k = slots_.at(identity);
    const Complex turn = std::polar(1.0, heading_), seen = landmarks_[k];
    const Complex place = place_ + turn * seen, by_heading = kI * seen;
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(2, P_.rows());
    T.leftCols<2>() = -Eigen::Matrix2d::Identity();
    T.col(2) << -by_heading.real(), -by_heading.imag();
    T.middleCols<2>(row_of(k)) = times(seen);
    T = product(times(turn), T);
    return {{place.real(), place.imag()}, product(product(T, P_), T.transpose())};
  }

  double log_likelihood = 0.0, nis = 0.0;  ///< of the last scan

 private:
  static Eigen::Index row_of(std::size_t k) { return 3 + 2 * static_cast<Eigen::Index>(k); }

  void use(const Detection& z, std::size_t slot) {
    const Complex seen = landmarks_[slot];
    const Eigen::Index row = row_of(slot);
    const Eigen::Vector2d nu(std::log(z[0] / std::abs(seen)), wrap(z[1] - std::arg(seen)));
    const Eigen::Vector2d sigma(belief_.sigma_range / std::abs(seen), belief_.sigma_bearing);
    Eigen::Matrix2d S = P_.block<2, 2>(row, row);
    S.diagonal() += sigma.cwiseAbs2();
    const double distance = nu.dot(S.inverse() * nu);
    nis += distance;
    // The density of (z_r, z_b) is that of (log z_r, z_b), divided by z_r.
    log_likelihood -= 0.5 * (distance + std::log(S.determinant())) + std::log(kTwoPi * z[0]);
    const Eigen::MatrixXd K = product(P_.middleCols<2>(row), S.inverse());
    const Eigen::VectorXd step = product(K, nu);
    P_ = (P_ - product(K, P_.middleRows<2>(row))).eval();
    for (std::size_t k = 0; k < landmarks_.size(); ++k)
      landmarks_[k] *= std::exp(Complex(step(row_of(k)), step(row_of(k) + 1)));
    const Complex way(step(0), step(1));
    place_ -= std::polar(1.0, heading_) * chord(-step(2)) * way;
    heading_ -= step(2);
    Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(P_.rows(), P_.rows());
    turned.topLeftCorner<3, 3>() = adjoint(chord(step(2)) * way, step(2));
    P_ = product(product(turned, P_), turned.transpose());
  }

  void append(const Detection& z) {
    const Eigen::Index n = P_.rows();
    slots_[z.identity] = landmarks_.size();
    landmarks_.push_back(std::polar(z[0], z[1]));
    P_.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 2, n + 2));
    P_(n, n) = std::pow(belief_.sigma_range / z[0], 2);
    P_(n + 1, n + 1) = std::pow(belief_.sigma_bearing, 2);
  }

  Belief belief_;
  Complex place_;
  double heading_ = 0.0;
  std::vector<Complex> landmarks_;  ///< {slot} as seen from the vehicle
  std::map<std::int32_t, std::size_t> slots_;
  Eigen::MatrixXd P_;
};

/// Noise that bends the models.
SmallWorldSettings settings() {
  SmallWorldSettings settings{.seed = 5, .landmarks = 21, .scans = 250};
  settings.noise.sigma_bearing = 0.05;
  return settings;
}

TEST(PolarEquivariant, EqualsTheLiteralFilter) {
  const SmallWorld world = small_world(settings());
  const Pose start{4.0, -3.0, 0.5};
  Literal literal(settings());
  std::vector<PoseMoments> expected;
  std::vector<std::array<double, 2>> innovations;
  drive_through(literal, world, start, [&](std::size_t) {
    expected.push_back(literal.moments());
    innovations.push_back({literal.log_likelihood, literal.nis});
  });
  const auto filter = make_filter(polar_equivariant_kind(), settings());
  drive_through(*filter, world, start, [&](std::size_t scan) {
    const PoseMoments pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, expected[scan].mean).norm(), 1e-9) << scan;
    EXPECT_LT((pose.covariance - expected[scan].covariance).norm(),
              1e-9 * expected[scan].covariance.norm())
        << scan;
    EXPECT_NEAR(filter->report().log_likelihood, innovations[scan][0], 1e-8) << scan;
    EXPECT_NEAR(filter->report().nis, innovations[scan][1], 1e-8) << scan;
  });
  std::vector<std::optional<LandmarkEstimate>> map(settings().landmarks);
  filter->map(map);
  std::size_t known = 0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (!map[k]) continue;
    const LandmarkEstimate there = literal.landmark(static_cast<std::int32_t>(k));
    EXPECT_LT((map[k]->mean - there.mean).norm(), 1e-9) << k;
    EXPECT_LT((map[k]->covariance - there.covariance).norm(), 1e-9) << k;
    ++known;
  }
  EXPECT_GE(known, 15U);
}

TEST(PolarEquivariant, DiffersFromFiltersWithOtherErrors) {
  const SmallWorld world = small_world(settings());
  const auto of = [&](const char* name) {
    const auto kind = std::ranges::find(filter_kinds(), name, &FilterKind::name);
    return estimates_of(*make_filter(*kind, settings()), world, Pose()).back();
  };
  const PoseMoments polar = of("polar_equivariant");
  for (const char* other : {"ekf_slam", "riekf_slam", "robocentric_ekf_slam"})
    EXPECT_GT(boxminus(polar.mean, of(other).mean).norm(), 1e-3) << other;
}

TEST(PolarEquivariant, LeavesOutARangeThatHasNoLogarithm) {
  const auto filter = make_filter(polar_equivariant_kind(), settings());
  const StepContext context(1, 0, 0, Parallel::serial());
  filter->start({});
  const std::vector<Detection> first{{5.0, 0.1, 0}}, negative{{-0.1, 0.2, 0}, {-0.2, 0.3, 1}};
  filter->update(context, first);
  const PoseMoments before = filter->estimate().spread;
  filter->update(context, negative);
  EXPECT_EQ(boxminus(filter->estimate().spread.mean, before.mean).norm(), 0.0);
  EXPECT_EQ(filter->report().map_size, 1.0);
  EXPECT_EQ(filter->report().nis_dof, 0U);
}

}  // namespace
}  // namespace montecarta::filters
