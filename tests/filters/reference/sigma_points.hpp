// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "tests/filters/reference/fast_slams.hpp"
#include "tests/filters/reference/particle.hpp"

#include <Eigen/Core>
#include <Eigen/Dense>

#include <cmath>

/// The square-root form and the central differences of EQUATIONS 3, literally.
/// The models as functions of stacked vectors, and the coordinates in which the filters' square
/// roots are triangular.
namespace montecarta::filters::reference {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;

/// a - b, with component `Angle` (if any) wrapped.
template <int Angle, int M>
Vector<M> difference(const Vector<M>& a, const Vector<M>& b) {
  Vector<M> d = a - b;
  if constexpr (Angle >= 0) d(Angle) = wrap(d(Angle));
  return d;
}

/// Second moments of (x, F(x)).
template <int N, int M>
struct Image {
  Vector<M> mean;
  Eigen::Matrix<double, M, M> covariance;
  Eigen::Matrix<double, N, M> cross;
};

/// The scaled unscented transform as the textbook has it: 2N + 1 points about `x`, out of the
/// columns of the square root S, through `model`, with weights w0, wc0 and wi.
template <int M, int Angle, int N, class Model>
Image<N, M> unscented(const Vector<N>& x, const Eigen::Matrix<double, N, N>& S, const Unscented& u,
                      const Model& model) {
  const double lambda = u.alpha * u.alpha * (N + u.kappa) - N;
  const double w0 = lambda / (N + lambda), wi = 1.0 / (2.0 * (N + lambda));
  const double wc0 = w0 + 1.0 - u.alpha * u.alpha + u.beta;
  Eigen::Matrix<double, N, 2 * N + 1> X;
  X.col(0) = x;
  for (int j = 0; j < N; ++j) {
    X.col(1 + j) = x + std::sqrt(N + lambda) * S.col(j);
    X.col(1 + N + j) = x - std::sqrt(N + lambda) * S.col(j);
  }
  const Vector<M> centre = model(x);
  Eigen::Matrix<double, M, 2 * N + 1> Y;  // as differences from the centre's image
  for (int k = 0; k <= 2 * N; ++k) {
    const Vector<N> point = X.col(k);
    Y.col(k) = difference<Angle, M>(model(point), centre);
  }
  Vector<M> shift = w0 * Y.col(0);
  for (int k = 1; k <= 2 * N; ++k) shift += wi * Y.col(k);
  Image<N, M> image{centre + shift, wc0 * (Y.col(0) - shift) * (Y.col(0) - shift).transpose(),
                    wc0 * (X.col(0) - x) * (Y.col(0) - shift).transpose()};
  for (int k = 1; k <= 2 * N; ++k) {
    image.covariance += wi * (Y.col(k) - shift) * (Y.col(k) - shift).transpose();
    image.cross += wi * (X.col(k) - x) * (Y.col(k) - shift).transpose();
  }
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

/// The lower triangular L, diagonal not negative, with L L' = A A' (the papers' "qr"): each row of
/// A is mirrored onto its axis. Eigen's own takes the compiler seconds for each size.
template <int N, int M>
Eigen::Matrix<double, N, N> tria(const Eigen::Matrix<double, N, M>& A) {
  static_assert(N <= M);
  Eigen::Matrix<double, N, M> L = A;
  for (int i = 0; i < N; ++i) {
    Vector<M> mirror = L.row(i);
    mirror.head(i).setZero();
    if (mirror.isZero(0.0)) continue;
    mirror(i) += std::copysign(mirror.norm(), mirror(i));
    const Vector<N> along = L * mirror * (2.0 / mirror.squaredNorm());
    L -= along * mirror.transpose();
  }
  Eigen::Matrix<double, N, N> lower = Eigen::Matrix<double, N, N>::Zero();
  for (int i = 0; i < N; ++i) {
    lower.col(i).tail(N - i) = (L(i, i) < 0.0 ? -1.0 : 1.0) * L.col(i).tail(N - i);
  }
  return lower;
}

/// S S' -> S S' - U U', one hyperbolic downdate per column of U; false where that is not positive.
template <int N, int M>
[[nodiscard]] bool cholupdate(Eigen::Matrix<double, N, N>& S,
                              const Eigen::Matrix<double, N, M>& U) {
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

/// First (A) and second (B) differences of a model, and the mean of its image (EQUATIONS 3).
template <int N, int M>
struct Differences {
  Vector<M> mean;
  Eigen::Matrix<double, M, N> A, B;
};

template <int M, int Angle, int N, class Model>
Differences<N, M> central_differences(const Vector<N>& x, const Eigen::Matrix<double, N, N>& S,
                                      double h, const Model& model) {
  const Vector<M> centre = model(x);
  Differences<N, M> image;
  Vector<M> sum = Vector<M>::Zero();  // of the outer points, as differences from the centre's image
  for (int i = 0; i < N; ++i) {
    const Vector<N> ahead = x + h * S.col(i), behind = x - h * S.col(i);
    const Vector<M> plus = difference<Angle, M>(model(ahead), centre);
    const Vector<M> minus = difference<Angle, M>(model(behind), centre);
    image.A.col(i) = (plus - minus) / (2.0 * h);
    image.B.col(i) = std::sqrt(h * h - 1.0) / (2.0 * h * h) * (plus + minus);
    sum += plus + minus;
  }
  image.mean = centre + 1.0 / (2.0 * h * h) * sum;
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

/// K = (P_xz / S_y') / S_y (EQUATIONS 3).
template <int N, int M>
Eigen::Matrix<double, N, M> gain(const Eigen::Matrix<double, N, M>& P_xz,
                                 const Eigen::Matrix<double, M, M>& S_y) {
  const Eigen::Matrix<double, M, M> inverse = S_y.inverse();
  const Eigen::Matrix<double, N, M> half = P_xz * inverse.transpose();
  return half * inverse;
}

/// The square root of S S' that is lower triangular in the coordinates y = T x, T orthogonal.
template <int N>
Eigen::Matrix<double, N, N> tria_in(const Eigen::Matrix<double, N, N>& T,
                                    const Eigen::Matrix<double, N, N>& S) {
  const Eigen::Matrix<double, N, N> turned = T * S;
  return T.transpose() * tria<N, N>(turned);
}

/// f of (pose, control noise, sensor noise); the last has no effect.
struct MotionModel {
  Control control;
  double duration;
  Vehicle vehicle;
  Vector<3> operator()(const Vector<7>& x) const {
    const Pose from{x(0), x(1), x(2)};
    return to_vector(move(from, Control{control[0] + x(3), control[1] + x(4)}, duration, vehicle));
  }
};

/// h of (pose, landmark, sensor noise).
struct ObservationModel {
  Vector<2> operator()(const Vector<7>& x) const {
    const auto observation = predicted_observation(Pose{x(0), x(1), x(2)}, Point{x(3), x(4)});
    return {observation.range + x(5), wrap(observation.bearing + x(6))};
  }
};

/// h of a landmark seen from `pose`.
struct LandmarkModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& f) const {
    return filters::to_vector(predicted_observation(pose, Point{f(0), f(1)}));
  }
};

/// g of (range, bearing) seen from `pose`.
struct PlaceModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& z) const {
    const double angle = pose.heading + z(1);
    return {pose.x + z(0) * std::cos(angle), pose.y + z(0) * std::sin(angle)};
  }
};

/// Coordinates (heading, x, y).
inline Eigen::Matrix3d heading_first() {
  return Eigen::Matrix3d{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
}
/// Coordinates (across, along) the line of sight from `pose` to `landmark`.
inline Eigen::Matrix2d across_first(const Vector<3>& pose, const Vector<2>& landmark) {
  const Vector<2> u = (landmark - pose.head<2>()).normalized();
  return Eigen::Matrix2d{{-u(1), u(0)}, {u(0), u(1)}};
}
/// Coordinates (across, along, heading).
inline Eigen::Matrix3d across_first_with_heading(const Vector<3>& pose, const Vector<2>& landmark) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topLeftCorner<2, 2>() = across_first(pose, landmark);
  return T;
}

/// Square roots along the diagonal.
template <int A, int B, int C>
Eigen::Matrix<double, A + B + C, A + B + C> blocks(const Eigen::Matrix<double, A, A>& a,
                                                   const Eigen::Matrix<double, B, B>& b,
                                                   const Eigen::Matrix<double, C, C>& c) {
  Eigen::Matrix<double, A + B + C, A + B + C> S;
  S.setZero();
  S.template topLeftCorner<A, A>() = a;
  S.template block<B, B>(A, A) = b;
  S.template bottomRightCorner<C, C>() = c;
  return S;
}

/// Whether a bearing can be told (EQUATIONS 2).
inline bool is_far_enough(const Vector<3>& pose, const Landmark& landmark) {
  return (landmark.mean - pose.head<2>()).norm() >= kLeastDistance;
}

}  // namespace montecarta::filters::reference
