// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/gaussian.hpp"
#include "filters/plain/landmark.hpp"

#include <cmath>

/// The two transforms by sigma points of EQUATIONS 3, the models as functions of stacked vectors,
/// and the coordinates in which the square roots are triangular.
namespace montecarta::filters::plain {

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
  Matrix<M> covariance;
  Matrix<N, M> cross;
};

/// Parameters of the scaled unscented transform (EQUATIONS 7).
struct Unscented {
  double alpha = 0.9;
  double beta = 2.0;
  double kappa = 0.0;
};

/// The scaled unscented transform of `model` (EQUATIONS (3.3), (3.4)): 2N + 1 points around x, from
/// the columns of the square root S.
template <int M, int Angle, int N, class Model>
Image<N, M> unscented(const Vector<N>& x, const Matrix<N>& S, const Unscented& u,
                      const Model& model) {
  const double lambda = u.alpha * u.alpha * (N + u.kappa) - N;
  const double w0 = lambda / (N + lambda), wi = 1.0 / (2.0 * (N + lambda));
  const double wc0 = w0 + 1.0 - u.alpha * u.alpha + u.beta;
  Matrix<N, 2 * N> X;  // without the centre
  X << std::sqrt(N + lambda) * S, -std::sqrt(N + lambda) * S;
  const Vector<M> centre = model(x);
  Matrix<M, 2 * N> Y;  // as differences from the image of the centre
  for (int k = 0; k < 2 * N; ++k) {
    const Vector<N> point = x + X.col(k);
    Y.col(k) = difference<Angle, M>(model(point), centre);
  }
  const Vector<M> shift = wi * Y.rowwise().sum();
  Y.colwise() -= shift;
  Image<N, M> image{centre + shift, wc0 * shift * shift.transpose() + wi * Y * Y.transpose(),
                    wi * X * Y.transpose()};
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

/// First (A) and second (B) differences of a model, and the mean of its image.
template <int N, int M>
struct Differences {
  Vector<M> mean;
  Matrix<M, N> A, B;
};

/// Central differences of `model` (EQUATIONS (3.5) to (3.7); Ankishan (10) to (14)): 2N + 1 points
/// around x, from the columns of the square root S.
template <int M, int Angle, int N, class Model>
Differences<N, M> central_differences(const Vector<N>& x, const Matrix<N>& S, double h,
                                      const Model& model) {
  const Vector<M> centre = model(x);
  Differences<N, M> image;
  Vector<M> sum = Vector<M>::Zero();  // as differences from the image of the centre
  for (int k = 0; k < N; ++k) {
    const Vector<N> ahead = x + h * S.col(k), behind = x - h * S.col(k);
    const Vector<M> plus = difference<Angle, M>(model(ahead), centre);
    const Vector<M> minus = difference<Angle, M>(model(behind), centre);
    image.A.col(k) = (plus - minus) / (2.0 * h);
    image.B.col(k) = std::sqrt(h * h - 1.0) / (2.0 * h * h) * (plus + minus);
    sum += plus + minus;
  }
  image.mean = centre + 1.0 / (2.0 * h * h) * sum;
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

/// f of (pose, noise of C controls, noise of the sensor); the last has no effect.
template <int C>
struct MotionModel {
  Control control;
  double duration;
  Vehicle vehicle;
  Vector<3> operator()(const Vector<5 + C>& x) const {
    Control u = control;
    for (int k = 0; k < C; ++k) u[static_cast<std::size_t>(k)] += x(3 + k);
    return to_vector(move(Pose{x(0), x(1), x(2)}, u, duration, vehicle));
  }
};

/// h of (pose, landmark, noise of the sensor).
struct ObservationModel {
  Vector<2> operator()(const Vector<7>& x) const {
    const auto observation = predicted_observation(Pose{x(0), x(1), x(2)}, Point{x(3), x(4)});
    return {observation.range + x(5), wrap(observation.bearing + x(6))};
  }
};

/// h of a landmark that is observed from `pose`.
struct LandmarkModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& f) const {
    return filters::to_vector(predicted_observation(pose, Point{f(0), f(1)}));
  }
};

/// g of (range, bearing) observed from `pose`.
struct PlaceModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& z) const {
    const double angle = pose.heading + z(1);
    return {pose.x + z(0) * std::cos(angle), pose.y + z(0) * std::sin(angle)};
  }
};

/// Coordinates (heading, x, y).
inline Matrix<3> heading_first() {
  return Matrix<3>{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
}
/// Coordinates (across, along) the line of sight from `pose` to `landmark`.
inline Matrix<2> across_first(const Vector<3>& pose, const Vector<2>& landmark) {
  const Vector<2> u = (landmark - pose.head<2>()).normalized();
  return Matrix<2>{{-u(1), u(0)}, {u(0), u(1)}};
}
/// Coordinates (across, along, heading).
inline Matrix<3> across_first_with_heading(const Vector<3>& pose, const Vector<2>& landmark) {
  Matrix<3> T = Matrix<3>::Identity();
  T.topLeftCorner<2, 2>() = across_first(pose, landmark);
  return T;
}

/// Square roots along the diagonal.
template <int A, int B, int C>
Matrix<A + B + C> blocks(const Matrix<A>& a, const Matrix<B>& b, const Matrix<C>& c) {
  Matrix<A + B + C> S = Matrix<A + B + C>::Zero();
  S.template topLeftCorner<A, A>() = a;
  S.template block<B, B>(A, A) = b;
  S.template bottomRightCorner<C, C>() = c;
  return S;
}

/// (a, b, 0, 0, ...).
template <int N, int A, int B>
Vector<N> stacked(const Vector<A>& a, const Vector<B>& b) {
  Vector<N> x = Vector<N>::Zero();
  x.template head<A>() = a;
  x.template segment<B>(A) = b;
  return x;
}

}  // namespace montecarta::filters::plain
