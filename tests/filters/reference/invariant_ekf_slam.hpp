// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/setup/filter_setup.hpp"

#include <Eigen/Dense>

#include <vector>

namespace montecarta::filters::reference {

/// Right-invariant EKF-SLAM as Barrau has it: the state is an element of SE_{1+n}(2), its error
/// xi = (x, y, heading, landmarks) with truth = exp(xi) estimate, full matrices, known association.
class InvariantEkfSlam {
 public:
  explicit InvariantEkfSlam(const Belief& belief) : belief_(belief) {}

  void start(const Pose& start) {
    heading = start.heading;
    points = {{start.x, start.y}};
    P = Eigen::MatrixXd::Zero(3, 3);
    identities.clear();
  }

  /// The error does not change but for the noise, which turns pose and map about the origin.
  void predict(const Control& u, double duration) {
    const double way = u[0] * duration;
    points[0] += way * Eigen::Vector2d(std::cos(heading + u[1]), std::sin(heading + u[1]));
    Eigen::RowVector2d turn(duration * std::sin(u[1]), way * std::cos(u[1]));
    turn /= std::get<Car>(belief_.vehicle).wheelbase;
    Eigen::Matrix2d shift;  // of the vehicle alone, by (speed, steer)
    shift << duration * std::cos(heading + u[1]), -way * std::sin(heading + u[1]),
        duration * std::sin(heading + u[1]), way * std::cos(heading + u[1]);
    heading = wrap(heading + way * std::sin(u[1]) / std::get<Car>(belief_.vehicle).wheelbase);
    Eigen::MatrixXd G(P.rows(), 2);
    G.row(2) = turn;
    for (std::size_t k = 0; k < points.size(); ++k) {
      G.middleRows<2>(row(k)) = -J() * points[k] * turn;
    }
    G.topRows<2>() += shift;
    const Eigen::Vector2d Q(std::pow(belief_.control.sigma[0], 2),
                            std::pow(belief_.control.sigma[1], 2));
    P += G * Q.asDiagonal() * G.transpose();
  }

  void update(Scan scan) {
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      const std::size_t k = point_of(detection.identity);
      k == 0 ? fresh.push_back(detection) : update_with(detection, k);
    }
    for (const Detection& detection : fresh) append(detection);
  }

  PoseMoments moments() const {
    return {{points[0].x(), points[0].y(), heading}, covariance().topLeftCorner<3, 3>()};
  }
  /// Covariance of (x, y, heading, landmarks) in the map frame: e = xi + J p xi_heading.
  Eigen::MatrixXd covariance() const {
    Eigen::MatrixXd T = Eigen::MatrixXd::Identity(P.rows(), P.rows());
    for (std::size_t k = 0; k < points.size(); ++k) T.block<2, 1>(row(k), 2) = J() * points[k];
    return T * P * T.transpose();
  }
  /// The index of a landmark in `points`; 0, the vehicle, if it is not in the map.
  std::size_t point_of(std::int32_t identity) const {
    for (std::size_t k = 0; k < identities.size(); ++k) {
      if (identities[k] == identity) return k + 1;
    }
    return 0;
  }
  static Eigen::Index row(std::size_t k) {
    return k == 0 ? 0 : 1 + 2 * static_cast<Eigen::Index>(k);
  }

  double heading = 0.0;
  std::vector<Eigen::Vector2d> points;  ///< vehicle, then landmarks in order of initialisation
  Eigen::MatrixXd P;                    ///< of the invariant error
  std::vector<std::int32_t> identities;

 private:
  static Eigen::Matrix2d J() { return Eigen::Matrix2d{{0.0, -1.0}, {1.0, 0.0}}; }
  Eigen::Matrix2d R() const {
    return Eigen::Vector2d(std::pow(belief_.sigma_range, 2), std::pow(belief_.sigma_bearing, 2))
        .asDiagonal();
  }
  static Eigen::Matrix2d rotation(double angle) {
    return Eigen::Rotation2Dd(angle).toRotationMatrix();
  }

  /// Range and bearing by a place in the frame of the vehicle.
  static Eigen::Matrix2d observation_by_place(const Eigen::Vector2d& b) {
    const double r = b.norm();
    return Eigen::Matrix2d{{b.x() / r, b.y() / r}, {-b.y() / (r * r), b.x() / (r * r)}};
  }

  void update_with(const Detection& detection, std::size_t k) {
    const Eigen::Matrix2d to_body = rotation(-heading);
    const Eigen::Vector2d b = to_body * (points[k] - points[0]);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, P.rows());
    H.middleCols<2>(row(k)) = observation_by_place(b) * to_body;
    H.leftCols<2>() = -H.middleCols<2>(row(k)).eval();
    const Eigen::Matrix2d S = H * P * H.transpose() + R();
    const Eigen::MatrixXd K = S.ldlt().solve(H * P).transpose();
    const Eigen::Vector2d innovation(detection[0] - b.norm(),
                                     wrap(detection[1] - std::atan2(b.y(), b.x())));
    multiply_by_exponential(K * innovation);
    const Eigen::MatrixXd I_KH = Eigen::MatrixXd::Identity(P.rows(), P.rows()) - K * H;
    P = (I_KH * P * I_KH.transpose() + K * R() * K.transpose()).eval();
  }

  /// estimate <- exp(xi) estimate.
  void multiply_by_exponential(const Eigen::VectorXd& xi) {
    const double a = xi(2);
    Eigen::Matrix2d V = Eigen::Matrix2d::Identity();
    if (std::abs(a) > 1e-9) {
      V = Eigen::Matrix2d{{std::sin(a), std::cos(a) - 1.0}, {1.0 - std::cos(a), std::sin(a)}} / a;
    }
    heading = wrap(heading + a);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] = (rotation(a) * points[k] + V * xi.segment<2>(row(k))).eval();
    }
  }

  /// A new landmark shares the vehicle's shift and has the sensor's noise; the heading cancels.
  void append(const Detection& detection) {
    const double ray = heading + detection[1];
    const Eigen::Vector2d u(std::cos(ray), std::sin(ray));
    const Eigen::Index n = P.rows();
    Eigen::MatrixXd grow = Eigen::MatrixXd::Zero(n + 2, n);
    grow.topRows(n).setIdentity();
    grow.bottomLeftCorner<2, 2>().setIdentity();
    Eigen::Matrix2d by_observation;
    by_observation << u, detection[0] * J() * u;
    P = (grow * P * grow.transpose()).eval();
    P.bottomRightCorner<2, 2>() += by_observation * R() * by_observation.transpose();
    points.push_back(points[0] + detection[0] * u);
    identities.push_back(detection.identity);
  }

  Belief belief_;
};

}  // namespace montecarta::filters::reference
