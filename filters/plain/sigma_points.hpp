// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/gaussian.hpp"
#include "filters/plain/landmark.hpp"

#include <cmath>
#include <functional>
#include <initializer_list>

/// The two transforms by sigma points of EQUATIONS 3, the models as functions of stacked vectors,
/// and the coordinates in which the square roots are triangular.
namespace montecarta::filters::plain {

/// A model as a function of one vector.
struct Model {
  std::function<SmallVector(const SmallVector&)> image;
  Eigen::Index angle = -1;  ///< component of the image that is an angle, -1 if none is

  SmallVector operator()(const SmallVector& x) const { return image(x); }
  SmallVector wrapped(SmallVector y) const {
    if (angle >= 0) y(angle) = wrap(y(angle));
    return y;
  }
};

/// Second moments of (x, F(x)).
struct Image {
  SmallVector mean;
  SmallMatrix covariance;
  SmallMatrix cross;
};

/// Parameters of the scaled unscented transform (EQUATIONS 7).
struct Unscented {
  double alpha = 0.9;
  double beta = 2.0;
  double kappa = 0.0;
};

/// The scaled unscented transform of `model` (EQUATIONS (3.3), (3.4)): 2n + 1 points around x, from
/// the columns of the square root S.
inline Image unscented(const SmallVector& x, const SmallMatrix& S, const Unscented& u,
                       const Model& model) {
  const auto n = static_cast<double>(x.size());
  const double lambda = u.alpha * u.alpha * (n + u.kappa) - n;
  const double w0 = lambda / (n + lambda), wi = 1.0 / (2.0 * (n + lambda));
  const double wc0 = w0 + 1.0 - u.alpha * u.alpha + u.beta;
  SmallMatrix X(x.size(), 2 * x.size());  // without the centre
  X << std::sqrt(n + lambda) * S, -std::sqrt(n + lambda) * S;
  const SmallVector centre = model(x);
  SmallMatrix Y(centre.size(), X.cols());  // as differences from the image of the centre
  for (Eigen::Index k = 0; k < X.cols(); ++k)
    Y.col(k) = model.wrapped(model(x + X.col(k)) - centre);
  const SmallVector shift = wi * Y.rowwise().sum();
  Y.colwise() -= shift;
  return {model.wrapped(centre + shift), wc0 * shift * shift.transpose() + wi * Y * Y.transpose(),
          wi * X * Y.transpose()};
}

/// First (A) and second (B) differences of a model, and the mean of its image.
struct Differences {
  SmallVector mean;
  SmallMatrix A, B;
};

/// Central differences of `model` (EQUATIONS (3.5) to (3.7); Ankishan (10) to (14)): 2n + 1 points
/// around x, from the columns of the square root S.
inline Differences central_differences(const SmallVector& x, const SmallMatrix& S, double h,
                                       const Model& model) {
  const SmallVector centre = model(x);
  const SmallMatrix none = SmallMatrix::Zero(centre.size(), x.size());
  Differences image{SmallVector::Zero(centre.size()), none, none};
  for (Eigen::Index k = 0; k < x.size(); ++k) {  // as differences from the image of the centre
    const SmallVector plus = model.wrapped(model(x + h * S.col(k)) - centre);
    const SmallVector minus = model.wrapped(model(x - h * S.col(k)) - centre);
    image.A.col(k) = (plus - minus) / (2.0 * h);
    image.B.col(k) = std::sqrt(h * h - 1.0) / (2.0 * h * h) * (plus + minus);
    image.mean += plus + minus;
  }
  image.mean = model.wrapped(centre + 1.0 / (2.0 * h * h) * image.mean);
  return image;
}

/// f of (pose, noise of the controls, noise of the sensor); the last has no effect.
inline Model motion_model(const Control& control, double duration, const Vehicle& vehicle) {
  const std::size_t n = controls_of(vehicle).size();
  return {[=](const SmallVector& x) -> SmallVector {
            Control u = control;
            for (std::size_t k = 0; k < n; ++k) u[k] += x(3 + static_cast<Eigen::Index>(k));
            return to_vector(move(Pose{x(0), x(1), x(2)}, u, duration, vehicle));
          },
          2};
}

/// h of (pose, landmark, noise of the sensor).
inline Model observation_model() {
  return {[](const SmallVector& x) -> SmallVector {
            const auto h = predicted_observation(Pose{x(0), x(1), x(2)}, Point{x(3), x(4)});
            return Vector<2>(h.range + x(5), wrap(h.bearing + x(6)));
          },
          1};
}

/// h of a landmark that is observed from `pose`.
inline Model landmark_model(const Pose& pose) {
  return {[=](const SmallVector& f) -> SmallVector {
            return filters::to_vector(predicted_observation(pose, Point{f(0), f(1)}));
          },
          1};
}

/// g of (range, bearing) observed from `pose`.
inline Model place_model(const Pose& pose) {
  return {[=](const SmallVector& z) -> SmallVector {
    const double angle = pose.heading + z(1);
    return Vector<2>(pose.x + z(0) * std::cos(angle), pose.y + z(0) * std::sin(angle));
  }};
}

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
inline SmallMatrix blocks(std::initializer_list<SmallMatrix> roots) {
  SmallMatrix S(0, 0);
  for (const SmallMatrix& root : roots) {
    const Eigen::Index n = S.rows(), m = root.rows();
    S.conservativeResizeLike(SmallMatrix::Zero(n + m, n + m));
    S.bottomRightCorner(m, m) = root;
  }
  return S;
}

/// (a, b, 0, 0, ...) of length n.
inline SmallVector stacked(const SmallVector& a, const SmallVector& b, Eigen::Index n) {
  SmallVector x = SmallVector::Zero(n);
  x.head(a.size()) = a;
  x.segment(a.size(), b.size()) = b;
  return x;
}

}  // namespace montecarta::filters::plain
