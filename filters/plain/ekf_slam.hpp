// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/association.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace montecarta::filters::plain {

/// EKF-SLAM (EQUATIONS 15; Smith et al. 1990; Thrun et al. 2005, table 10.1): one Gaussian over the
/// pose and all landmarks. Detections update it one by one. Its variants override where the motion
/// and the observations are linearised, or what the error is of which P_ is the covariance.
class EkfSlam : public SlamFilter {
 public:
  explicit EkfSlam(const FilterSetup& setup) : setup_(setup), R_(observation_noise(setup.belief)) {}

  void start(const Pose& start) override {
    start_from(StepContext::before_all_steps(), {.pose = {start}});
  }
  /// A known map is part of the state from the start; its landmarks are independent.
  void start_from(const StepContext& /*context*/, const Prior& prior) override {
    const auto n = static_cast<Eigen::Index>(3 + 2 * prior.map.size());
    mean_.setZero(n);
    P_.setZero(n, n);
    mean_.head<3>() = to_vector(prior.pose.mean);
    P_.topLeftCorner<3, 3>() = prior.pose.covariance;
    identities_.clear();
    for (const LandmarkEstimate& known : prior.map) {
      const Eigen::Index row = row_of(identities_.size());
      mean_.segment<2>(row) = known.mean;
      P_.block<2, 2>(row, row) = known.covariance;
      identities_.push_back(static_cast<std::int32_t>(identities_.size()));
    }
    report_ = {};
    fix_.reset();
  }

  /// Moves the pose (EQUATIONS (1.3), (1.4)) and its covariances with the landmarks.
  void predict(const StepContext& /*context*/, const Control& u, double duration) override {
    const auto step = linearised_move(pose(), u, duration, setup_.belief.vehicle);
    const ControlJacobian Fu = control_jacobian(step.jacobians);
    move_pose(step.pose, pose_jacobian(step.jacobians),
              Fu * control_noise(setup_.belief, u) * Fu.transpose() +
                  increment_covariance(setup_.belief, mean_(2), u, duration));
  }

  void take_fix(const PositionFix& fix) override { fix_ = fix; }

  void update(const StepContext& /*context*/, Scan scan) override {
    report_ = {};
    if (fix_) use_fix(*std::exchange(fix_, std::nullopt));
    const std::vector<Pairing> pairings = associated(scan);
    report_.association = association_counts(scan, pairings, identities_);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings[k].kind != PairingKind::matched) {
        report_.log_likelihood += log_unmatched(setup_);
      } else if (const auto v = innovation(pairings[k].landmark, scan[k])) {
        condition(*v);
      }
    }
    if (!std::isfinite(report_.log_likelihood))
      throw std::runtime_error("the log-likelihood of the scan is not finite");
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings[k].kind == PairingKind::fresh) initialise(scan[k]);
    }
    refuse_large_map(identities_.size(), setup_.association);
    report_.map_size = static_cast<double>(identities_.size());
  }

  PoseEstimate estimate() const override {
    return {{pose(), covariance().topLeftCorner<3, 3>()}, std::nullopt};
  }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    const Eigen::MatrixXd P = covariance();
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      landmarks[k].reset();
      const auto slot = slot_of(k, identities_, setup_.association.kind);
      if (!slot) continue;
      const Eigen::Index row = row_of(*slot);
      landmarks[k] = {mean_.segment<2>(row), P.block<2, 2>(row, row)};
    }
  }

  /// Pose, then the landmarks in the order of their initialisation.
  const Eigen::VectorXd& mean() const { return mean_; }
  /// Covariance of truth minus mean.
  virtual Eigen::MatrixXd covariance() const { return P_; }

 protected:
  Pose pose() const { return as_pose(mean_.head<3>()); }
  static Eigen::Index row_of(std::size_t slot) { return 3 + 2 * static_cast<Eigen::Index>(slot); }

  /// Moves the pose to `there`, with the derivative Fx by the pose before and the covariance of the
  /// noise.
  void move_pose(const Pose& there, const Matrix<3>& Fx, const Matrix<3>& noise) {
    mean_.head<3>() = to_vector(there);
    P_.topRows<3>() = (Fx * P_.topRows<3>()).eval();
    P_.leftCols<3>() = (P_.leftCols<3>() * Fx.transpose()).eval();
    P_.topLeftCorner<3, 3>() += noise;
  }

  /// nu = z - h of a landmark, and H = [Hx 0 ... Hf ... 0]; nullopt if the landmark is too near.
  virtual std::optional<LinearisedInnovation> linearised(std::size_t slot,
                                                         const Detection& z) const {
    return innovation_at(mean_.head<3>(), certain_landmark(mean_.segment<2>(row_of(slot))), z, R_);
  }

  /// H of the position of the vehicle: one for it and zero else (EQUATIONS (24.1)).
  virtual Matrix<2, Eigen::Dynamic> derivative_of_position() const {
    Matrix<2, Eigen::Dynamic> H = Matrix<2, Eigen::Dynamic>::Zero(2, mean_.size());
    H.leftCols<2>().setIdentity();
    return H;
  }

  /// A landmark whose covariance is left to S = H P H' + R.
  static Landmark certain_landmark(const Vector<2>& place) {
    return {.mean = place, .covariance = Matrix<2>::Zero()};
  }

  /// Moves the mean by a step K nu.
  virtual void move_mean(const Eigen::VectorXd& step) {
    mean_ += step;
    mean_(2) = wrap(mean_(2));
  }

  /// Gx, the derivative of a new landmark by the pose.
  virtual Matrix23 derivative_by_pose(const LinearisedPlace<double>& placed) const {
    return pose_jacobian(placed);
  }

  /// Adds a landmark at g(x, z), with derivatives Gx and Gz (EQUATIONS (15.2)).
  virtual void initialise(const Detection& z) {
    const auto placed = linearised_place(pose(), observation_of(z));
    const Matrix23 Gx = derivative_by_pose(placed);
    const Matrix<2> Gz = observation_jacobian(placed);
    const Eigen::Index n = mean_.size();
    mean_.conservativeResize(n + 2);
    P_.conservativeResize(n + 2, n + 2);
    mean_.tail<2>() = to_vector(placed.point);
    P_.bottomLeftCorner(2, n) = Gx * P_.topLeftCorner(3, n);
    P_.topRightCorner(n, 2) = P_.bottomLeftCorner(2, n).transpose();
    P_.bottomRightCorner<2, 2>() =
        Gx * P_.topLeftCorner<3, 3>() * Gx.transpose() + Gz * R_ * Gz.transpose();
    identities_.push_back(z.identity);
  }

  FilterSetup setup_;
  Matrix<2> R_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd P_;

 private:
  /// An innovation with all that the update needs.
  struct JointInnovation {
    plain::Innovation value;
    Eigen::Matrix<double, Eigen::Dynamic, 2> cross;  ///< P H'
  };

  std::vector<Pairing> associated(Scan scan) const {
    if (setup_.association.kind == Association::known) return pair_by_identity(scan, identities_);
    const auto predict = [&](std::uint32_t slot, const Detection& z) {
      const auto v = innovation(slot, z);
      return v ? std::optional(v->value) : std::nullopt;
    };
    return pair_nearest(scan, identities_.size(), setup_.association, predict);
  }

  /// nu and S = H P H' + R; nullopt if the landmark is too near.
  std::optional<JointInnovation> innovation(std::size_t slot, const Detection& z) const {
    const Eigen::Index row = row_of(slot);
    const auto v = linearised(slot, z);
    if (!v) return std::nullopt;
    const Eigen::Matrix<double, Eigen::Dynamic, 2> cross =
        P_.leftCols<3>() * v->Hx.transpose() + P_.middleCols<2>(row) * v->Hf.transpose();
    const Matrix<2> S = v->Hx * cross.topRows<3>() + v->Hf * cross.middleRows<2>(row) + R_;
    return JointInnovation{{v->nu, S}, cross};
  }

  /// m <- m + K nu, P <- P - K S K' (EQUATIONS (15.1)).
  void move_by(const JointInnovation& v) {
    const auto& [nu, S] = v.value;
    const Eigen::Matrix<double, Eigen::Dynamic, 2> K =
        S.llt().solve(v.cross.transpose()).transpose();
    move_mean(K * nu);
    P_ -= K * S * K.transpose();
    report_.log_likelihood += log_gaussian<2>(nu, S);
  }
  void condition(const JointInnovation& v) {
    move_by(v);
    report_.nis += squared_distance(v.value.nu, v.value.S);
    report_.nis_dof += 2;
  }

  /// Conditions pose and map on a fix of the position.
  void use_fix(const PositionFix& fix) {
    const Matrix<2, Eigen::Dynamic> H = derivative_of_position();
    const double sigma = setup_.belief.sigma_fix.value();
    const Eigen::Matrix<double, Eigen::Dynamic, 2> cross = P_ * H.transpose();
    const Matrix<2> S = H * cross + sigma * sigma * Matrix<2>::Identity();
    move_by({{fix - mean_.head<2>(), S}, cross});
  }

  std::optional<PositionFix> fix_;        ///< fix for the next scan
  std::vector<std::int32_t> identities_;  ///< {landmark} of the detection that initialised it
  ScanReport report_;
};

}  // namespace montecarta::filters::plain
