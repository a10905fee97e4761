// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Dense>

#include <vector>

namespace montecarta::filters::reference {

/// A B and A P A' of full matrices; every size alike, which spares the compiler most of its work.
inline Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B; }
inline Eigen::MatrixXd sandwich(const Eigen::MatrixXd& A, const Eigen::MatrixXd& P) {
  return product(product(A, P), A.transpose());
}

/// EKF-SLAM with full matrices at every step, known association; as the textbook has it and as
/// slow.
class TextbookEkfSlam {
 public:
  explicit TextbookEkfSlam(const Belief& belief) : belief_(belief) {}

  void start(const Pose& start) {
    mean.resize(3);
    mean << start.x, start.y, start.heading;
    covariance = Eigen::MatrixXd::Zero(3, 3);
    identities.clear();
  }

  void predict(const Control& control, double duration) {
    const auto step = linearised_move(pose(), control, duration, belief_.vehicle);
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(mean.size(), mean.size());
    F.topLeftCorner<3, 3>() = pose_jacobian(step.jacobians);
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(mean.size(), 2);
    G.topRows<3>() = control_jacobian(step.jacobians);
    const Eigen::Vector2d Q(std::pow(belief_.control.sigma[0], 2),
                            std::pow(belief_.control.sigma[1], 2));
    mean.head<3>() << step.pose.x, step.pose.y, step.pose.heading;
    covariance = sandwich(F, covariance) + sandwich(G, Q.asDiagonal());
  }

  void update(Scan scan) {
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      const Eigen::Index row = row_of(detection.identity);
      if (row < 0) {
        fresh.push_back(detection);
      } else {
        update_with(detection, row);
      }
    }
    for (const Detection& detection : fresh) append(detection);
  }

  /// What a landmark should look like, and its derivative by pose and map.
  struct Look {
    RangeBearing<double> observation;
    Eigen::MatrixXd H;
  };
  Look look(Eigen::Index row) const {
    const auto at = linearised_observation(pose(), Point{mean(row), mean(row + 1)});
    Look look{at.observation, Eigen::MatrixXd::Zero(2, mean.size())};
    look.H.leftCols<3>() = pose_jacobian(at);
    look.H.middleCols<2>(row) = landmark_jacobian(at);
    return look;
  }

  Pose pose() const { return {mean(0), mean(1), mean(2)}; }
  /// First of the two rows of a landmark, -1 where it is not in the map.
  Eigen::Index row_of(std::int32_t identity) const {
    for (std::size_t k = 0; k < identities.size(); ++k) {
      if (identities[k] == identity) return 3 + 2 * static_cast<Eigen::Index>(k);
    }
    return -1;
  }

  Eigen::VectorXd mean;  ///< pose, then landmarks in order of initialisation
  Eigen::MatrixXd covariance;
  std::vector<std::int32_t> identities;

 private:
  Eigen::Matrix2d R() const {
    return Eigen::Vector2d(std::pow(belief_.sigma_range, 2), std::pow(belief_.sigma_bearing, 2))
        .asDiagonal();
  }
  void update_with(const Detection& detection, Eigen::Index row) {
    const auto [observation, H] = look(row);
    const Eigen::Matrix2d S = sandwich(H, covariance) + R();
    const Eigen::Matrix2d per_S = S.ldlt().solve(Eigen::Matrix2d::Identity());
    const Eigen::MatrixXd K = product(product(covariance, H.transpose()), per_S);
    mean += product(K, to_vector(residual(observation_of(detection), observation)));
    mean(2) = wrap(mean(2));
    const Eigen::MatrixXd I_KH =
        Eigen::MatrixXd::Identity(mean.size(), mean.size()) - product(K, H);
    covariance = sandwich(I_KH, covariance) + sandwich(K, R());
  }

  void append(const Detection& detection) {
    const auto placed = linearised_place(pose(), observation_of(detection));
    const Eigen::Matrix2d Gz = observation_jacobian(placed);
    const Eigen::Index n = mean.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n + 2, n);
    G.topRows(n).setIdentity();
    G.bottomLeftCorner<2, 3>() = pose_jacobian(placed);
    Eigen::MatrixXd grown = sandwich(G, covariance);
    grown.bottomRightCorner<2, 2>() += Gz * R() * Gz.transpose();
    covariance = grown;
    mean.conservativeResize(n + 2);
    mean.tail<2>() = to_vector(placed.point);
    identities.push_back(detection.identity);
  }

  Belief belief_;
};

}  // namespace montecarta::filters::reference
