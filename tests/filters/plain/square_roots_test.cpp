// SPDX-License-Identifier: BSD-3-Clause
#include "filters/plain/square_roots.hpp"

#include "engine/random/stream.hpp"
#include "filters/plain/sigma_points.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters::plain {
namespace {

const double kInterval = std::sqrt(3.0);

template <int N, int M>
Eigen::Matrix<double, N, M> random_matrix(RngStream& draw) {
  return Eigen::Matrix<double, N, M>::NullaryExpr([&](Eigen::Index) { return draw.normal(); });
}

/// x' = F x + G w, z = H x + v; w and v with the square roots Q and R.
struct LinearSystem {
  Eigen::Matrix3d F;
  Eigen::Matrix<double, 3, 2> G;
  Eigen::Matrix<double, 2, 3> H;
  Eigen::Matrix2d Q, R;
  explicit LinearSystem(RngStream& draw)
      : F(0.5 * random_matrix<3, 3>(draw)),
        G(random_matrix<3, 2>(draw)),
        H(random_matrix<2, 3>(draw)),
        Q(random_matrix<2, 2>(draw)),
        R(random_matrix<2, 2>(draw) + Eigen::Matrix2d::Identity()) {}
};

Model linear(const SmallMatrix& H) {
  return {[=](const SmallVector& x) -> SmallVector { return H * x; }};
}

/// EQUATIONS 3 with the process noise augmented and the sensor's added.
struct SquareRootFilter {
  Vector<3> x = Vector<3>::Zero();
  Eigen::Matrix3d S = Eigen::Matrix3d::Identity();

  void predict(const LinearSystem& system) {
    const Model model{[&](const SmallVector& v) -> SmallVector {
      return system.F * v.head(3) + system.G * v.tail(2);
    }};
    const auto image =
        central_differences(stacked(x, {}, 5), blocks({S, system.Q}), kInterval, model);
    x = image.mean;
    S = tria_of({image.A, image.B});
  }

  void update(const LinearSystem& system, const Vector<2>& z) {
    const auto image = central_differences(x, S, kInterval, linear(system.H));
    const SmallMatrix S_y = tria_of({image.A, image.B, system.R});
    const SmallMatrix K = square_root_gain(S * image.A.transpose(), S_y);
    x += K * (z - image.mean);
    S = tria_of({S - K * image.A, K * image.B, K * system.R});
  }
};

struct KalmanFilter {
  Vector<3> x = Vector<3>::Zero();
  Eigen::Matrix3d P = Eigen::Matrix3d::Identity();

  void predict(const LinearSystem& s) {
    x = (s.F * x).eval();
    P = (s.F * P * s.F.transpose() + s.G * s.Q * s.Q.transpose() * s.G.transpose()).eval();
  }
  void update(const LinearSystem& s, const Vector<2>& z) {
    const Eigen::Matrix2d S_z = s.H * P * s.H.transpose() + s.R * s.R.transpose();
    const Eigen::Matrix<double, 3, 2> K = S_z.llt().solve(s.H * P).transpose();
    x += (K * (z - s.H * x)).eval();
    P -= (K * S_z * K.transpose()).eval();
  }
};

TEST(SquareRootCentralDifferences, AreTheKalmanFilterOnLinearSystems) {
  RngStream draw({.seed = 231, .purpose = Draw::test});
  for (int n = 0; n < 1000; ++n) {
    const LinearSystem system(draw);
    SquareRootFilter root;
    KalmanFilter kalman;
    for (int step = 0; step < 5; ++step) {
      const Vector<2> z = random_matrix<2, 1>(draw);
      root.predict(system), kalman.predict(system);
      root.update(system, z), kalman.update(system, z);
    }
    const Eigen::Matrix3d P = root.S * root.S.transpose();
    EXPECT_LT((root.x - kalman.x).norm(), 1e-11 * (1.0 + kalman.x.norm())) << "system " << n;
    EXPECT_LT((P - kalman.P).norm(), 1e-11 * (1.0 + kalman.P.norm())) << "system " << n;
  }
}

TEST(CentralDifferences, HaveTheMomentsOfAQuadraticButNotOfAProduct) {
  RngStream draw({.seed = 232, .purpose = Draw::test});
  using One = Vector<1>;
  for (int n = 0; n < 200; ++n) {
    const double a = draw.normal(), b = draw.normal(), c = draw.normal(), m = draw.normal();
    const double s = 0.1 + draw.uniform(), h = 1.1 + 2.0 * draw.uniform();
    const Model quadratic{
        [&](const SmallVector& x) -> SmallVector { return One(a + b * x(0) + c * x(0) * x(0)); }};
    const double mean = a + b * m + c * (m * m + s * s);
    const double variance = std::pow((b + 2 * c * m) * s, 2) + 2 * std::pow(c * s * s, 2);
    EXPECT_NEAR(central_differences(One(m), One(s), h, quadratic).mean(0), mean, 1e-12);
    const auto image = central_differences(One(m), One(s), kInterval, quadratic);
    EXPECT_NEAR(image.A.squaredNorm() + image.B.squaredNorm(), variance, 1e-12 * (1 + variance));
  }
  const Eigen::Matrix2d S = Eigen::Matrix2d::Identity();
  const Model product{[](const SmallVector& x) -> SmallVector { return One(x(0) * x(1)); }};
  const auto image = central_differences(Vector<2>(0.0, 0.0), S, kInterval, product);
  EXPECT_EQ(image.A.squaredNorm() + image.B.squaredNorm(), 0.0) << "truth is 1: a known defect";
}

/// A bent model of three variables.
SmallVector bent(const SmallVector& x) {
  return Vector<2>(std::sqrt(4.0 + x.squaredNorm()), std::atan2(x(1), 3.0 + x(0)) - x(2));
}

/// S S' -> S S' - U U', one hyperbolic downdate per column of U; false if that is not positive.
template <int N, int M>
[[nodiscard]] bool cholupdate(Matrix<N>& S, const Matrix<N, M>& U) {
  for (int c = 0; c < M; ++c) {
    Vector<N> u = U.col(c);
    for (int k = 0; k < N; ++k) {
      const double square = S(k, k) * S(k, k) - u(k) * u(k);
      if (square <= 0.0) return false;
      const double root = std::sqrt(square), cosine = root / S(k, k), sine = u(k) / S(k, k);
      S(k, k) = root;
      for (int i = k + 1; i < N; ++i) {
        S(i, k) = (S(i, k) - sine * u(i)) / cosine;
        u(i) = cosine * u(i) - sine * S(i, k);
      }
    }
  }
  return true;
}

TEST(SquareRootUpdate, ThreeFormsAgree) {
  RngStream draw({.seed = 234, .purpose = Draw::test});
  for (int n = 0; n < 1000; ++n) {
    Eigen::Matrix3d S = tria(0.3 * random_matrix<3, 3>(draw));
    const Eigen::Matrix2d R = 0.1 * random_matrix<2, 2>(draw);
    const Vector<3> x = random_matrix<3, 1>(draw);
    const auto image = central_differences(x, S, kInterval, {bent});
    const Eigen::Matrix2d S_y = tria_of({image.A, image.B, R});
    const Eigen::Matrix<double, 3, 2> K = square_root_gain(S * image.A.transpose(), S_y);
    const Eigen::Matrix3d by_tria = tria_of({S - K * image.A, K * image.B, K * R});
    Eigen::Matrix3d by_downdate = S;
    ASSERT_TRUE((cholupdate<3, 2>(by_downdate, K * S_y)));
    const Eigen::Matrix3d P = S * S.transpose() - K * S_y * S_y.transpose() * K.transpose();
    EXPECT_LT((by_tria * by_tria.transpose() - P).norm(), 1e-12);
    EXPECT_LT((by_downdate * by_downdate.transpose() - P).norm(), 1e-12);
  }
}

TEST(SquareRootUpdate, ADowndateThatTakesMoreThanThereIsIsRefused) {
  Eigen::Matrix2d S;
  S << 1.0, 0.0, 0.5, 0.3;
  EXPECT_FALSE((cholupdate<2, 1>(S, Vector<2>(1.0, 0.0))));
  S << 1.0, 0.0, 0.5, 0.3;
  EXPECT_FALSE((cholupdate<2, 1>(S, Vector<2>(0.0, 0.4)))) << "in the second pivot";
  S << 1.0, 0.0, 0.5, 0.3;
  EXPECT_TRUE((cholupdate<2, 1>(S, Vector<2>(0.0, 0.2))));
}

TEST(InnovationOfEquation26, IsThatOfPoseMapAndSensorOnALinearModel) {
  RngStream draw({.seed = 236, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Eigen::Matrix3d S = tria(random_matrix<3, 3>(draw));
    const Eigen::Matrix2d Sf = random_matrix<2, 2>(draw), R = random_matrix<2, 2>(draw);
    const auto Hx = random_matrix<2, 3>(draw);
    const auto Hf = random_matrix<2, 2>(draw);
    const auto of_pose = central_differences(SmallVector::Zero(3), S, kInterval, linear(Hx));
    const auto of_map = central_differences(SmallVector::Zero(2), Sf, kInterval, linear(Hf));
    const Eigen::Matrix2d S_bar =
        of_map.A * of_map.A.transpose() + of_map.B * of_map.B.transpose() + R * R.transpose();
    const Eigen::Matrix3d P = S * S.transpose();
    const Eigen::Matrix2d truth = Hx * P * Hx.transpose() + S_bar;
    const Eigen::Matrix<double, 3, 2> P_xz = S * of_pose.A.transpose();
    const Eigen::Matrix2d corrected = P_xz.transpose() * P.llt().solve(P_xz) + S_bar;
    EXPECT_LT((corrected - truth).norm(), 1e-7 * truth.norm());  // P may be all but singular
    const Eigen::Matrix2d by_columns = of_pose.A * of_pose.A.transpose() + S_bar;
    EXPECT_LT((by_columns - truth).norm(), 1e-13 * truth.norm());
    const Eigen::Matrix2d printed =
        P_xz.transpose() * S.triangularView<Eigen::Lower>().solve(P_xz) + S_bar;
    EXPECT_GT((printed - printed.transpose()).norm(), 1e-9) << "a factor where P belongs";
  }
}

}  // namespace
}  // namespace montecarta::filters::plain
