// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/association.hpp"
#include "tests/filters/reference/gaussian.hpp"
#include "tests/filters/reference/particle_moments.hpp"
#include "tests/filters/reference/resampling.hpp"
#include "tests/filters/reference/shared_map.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

namespace montecarta::filters::reference {

/// Marginal and auxiliary marginal particle filter as EQUATIONS 12 writes them, in plain Eigen:
/// what production is held to.
class Marginal : public SlamFilter {
 public:
  Marginal(const MarginalSettings& settings, const FilterSetup& setup)
      : settings_(settings), setup_(setup), learning_(settings.map, setup.belief) {
    const Belief& b = setup.belief;
    R_ = Eigen::Vector2d(std::pow(b.sigma_range, 2), std::pow(b.sigma_bearing, 2)).asDiagonal();
    Q_ = Eigen::Vector2d(std::pow(b.control.sigma[0], 2), std::pow(b.control.sigma[1], 2))
             .asDiagonal();
    floor_ = Eigen::Vector3d(std::pow(settings.kernel_floor_xy, 2),
                             std::pow(settings.kernel_floor_xy, 2),
                             std::pow(settings.kernel_floor_heading, 2))
                 .asDiagonal();
  }

  void start(const Pose& start) override {
    const double M = static_cast<double>(settings_.particles);
    const Gaussian first{to_vector(start), Eigen::Matrix3d::Zero(), -std::log(M)};
    kernels_.assign(settings_.particles, first);
    map_.assign(known() ? setup_.landmarks : 0, std::nullopt);
    numbers_.assign(map_.size(), 0);
    initialised_ = 0;
    report_ = {};
  }

  void predict(const StepContext&, const Control& control, double duration) override {
    for (Gaussian& kernel : kernels_) {
      const auto step =
          linearised_move(as_pose(kernel.mean), control, duration, setup_.belief.vehicle);
      const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
      const Matrix32 G = control_jacobian(step.jacobians);
      kernel.covariance = (F * kernel.covariance * F.transpose() + G * Q_ * G.transpose()).eval();
      kernel.mean = to_vector(step.pose);
    }
  }

  void update(const StepContext& context, Scan scan) override {
    ancestors_.resize(kernels_.size());
    std::iota(ancestors_.begin(), ancestors_.end(), 0U);
    report_ = {.ess = effective(weights())};
    pair(scan);
    if (count(PairingKind::ignored) < scan.size()) {  // else the kernels go on growing
      draw_and_weigh(context, scan);
      if (!known()) {
        const auto unmatched = static_cast<double>(scan.size() - count(PairingKind::matched));
        report_.log_likelihood += unmatched * log_unmatched(setup_.association, setup_.belief);
      }
      learn(context, scan);
    }
    report_.map_size = initialised_;
  }

  PoseEstimate estimate() const override {
    return {mixture(Eigen::Matrix3d::Zero()), std::nullopt};
  }
  const ScanReport& report() const override { return report_; }
  void particles(const ParticleColumns& columns) const override {
    for (std::size_t i = 0; i < kernels_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        columns.pose[3 * i + k] = kernels_[i].mean(static_cast<Eigen::Index>(k));
      columns.log_weight[i] = kernels_[i].log_weight;
      columns.ancestor[i] = ancestors_[i];
    }
  }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      landmarks[k].reset();
      if (k < map_.size() && map_[k]) landmarks[k] = {map_[k]->mean, map_[k]->covariance};
    }
  }

  const std::vector<Pairing>& pairings() const { return pairings_; }  ///< of the last scan
  const SharedMapLearning& learning() const { return learning_; }

 private:
  /// N(mean, covariance) and its weight; no covariance right after a draw.
  struct Gaussian {
    Eigen::Vector3d mean;
    Eigen::Matrix3d covariance;
    double log_weight;
  };

  bool known() const { return setup_.association.kind == Association::known; }
  std::vector<double> weights() const {
    std::vector<double> w;
    for (const Gaussian& kernel : kernels_) w.push_back(std::exp(kernel.log_weight));
    return w;
  }
  static double normalise(std::vector<double>& w) {
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    for (double& x : w) x /= sum;
    return sum;
  }
  static double effective(const std::vector<double>& w) {
    return 1.0 / std::inner_product(w.begin(), w.end(), w.begin(), 0.0);
  }
  PoseMoments mixture(const Eigen::Matrix3d& floor) const {
    return mixture_moments(
        kernels_, [](const Gaussian& kernel) { return kernel.mean; },
        [&](const Gaussian& kernel) -> Eigen::Matrix3d { return kernel.covariance + floor; });
  }

  /// EQUATIONS 17: once for all, from the weighted mean pose. Landmarks of a one-step map are
  /// parameters to the likelihood, without a covariance.
  void pair(Scan scan) {
    const auto [mean, P] = mixture(floor_);
    const NearestNeighbour nearest{setup_.association, R_, to_vector(mean), P};
    believed_ = map_;
    for (auto& landmark : believed_) {
      if (landmark && settings_.map.mode != MapMode::recursive) landmark->covariance.setZero();
    }
    pairings_ = known() ? pair_by_identity(scan, map_) : nearest.pair(scan, believed_);
  }
  std::size_t count(PairingKind kind) const {
    std::size_t n = 0;
    for (const Pairing& pairing : pairings_) n += pairing.kind == kind;
    return n;
  }

  /// EQUATIONS (12.2) to (12.4).
  void draw_and_weigh(const StepContext& context, Scan scan) {
    const std::size_t M = kernels_.size();
    const std::vector<double> w = weights();
    std::vector<Gaussian> prior = kernels_;
    for (Gaussian& kernel : prior) kernel.covariance += floor_;
    std::vector<Gaussian> proposal = prior;
    std::vector<double> lambda = w;
    predicted_.assign(scan.size(), {});
    for (std::size_t j = 0; j < M; ++j) {
      const double log_explained = explain(proposal[j], scan, w[j]);
      if (settings_.choice == Choice::by_likelihood) lambda[j] *= std::exp(log_explained);
    }
    normalise(lambda);
    ancestors_ = draw_parents(Scheme::stratified, lambda, context);
    std::vector<double> weighed;
    for (std::uint32_t i = 0; i < M; ++i) {
      const Eigen::Vector3d pose = draw(context, i, proposal[ancestors_[i]]);
      double numerator = 0.0, denominator = 0.0;
      for (std::size_t j = 0; j < M; ++j) {
        numerator += w[j] * density(prior[j], pose);
        denominator += lambda[j] * density(proposal[j], pose);
      }
      weighed.push_back(std::exp(log_likelihood(pose, scan)) * numerator / denominator);
      kernels_[i] = {pose, Eigen::Matrix3d::Zero(), 0.0};
    }
    report_.log_likelihood = std::log(normalise(weighed) / static_cast<double>(M));
    for (std::size_t i = 0; i < M; ++i) kernels_[i].log_weight = std::log(weighed[i]);
    report_.ess = effective(weighed);
    report_.resampled = true;
    tell_innovations();
  }

  double log_likelihood(const Eigen::Vector3d& x, Scan scan) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(x, *believed_[pairings_[k].landmark], scan[k], R_);
      sum += log_gaussian<2>(seen->nu, seen->S_f);
    }
    return sum;
  }

  /// log p(z | kernel), by its mean or, where poses are drawn from posteriors, as it becomes one.
  double explain(Gaussian& g, Scan scan, double weight) {
    double sum = 0.0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(g.mean, *believed_[pairings_[k].landmark], scan[k], R_);
      const Eigen::Matrix2d S = seen->Hx * g.covariance * seen->Hx.transpose() + seen->S_f;
      predicted_[k].mean += weight * seen->nu;
      predicted_[k].square += weight * (S + seen->nu * seen->nu.transpose());
      const bool becomes_posterior = settings_.kernel == Kernel::posterior;
      sum += log_gaussian<2>(seen->nu, becomes_posterior ? S : seen->S_f);
      if (!becomes_posterior) continue;
      const Matrix32 K = g.covariance * seen->Hx.transpose() * S.inverse();
      g.mean += K * seen->nu;
      g.covariance -= (K * S * K.transpose()).eval();
    }
    return sum;
  }

  /// nu' S^-1 nu of what all kernels together predicted.
  void tell_innovations() {
    for (std::size_t k = 0; k < pairings_.size(); ++k) {
      if (pairings_[k].kind != PairingKind::matched) continue;
      const auto& [mean, square] = predicted_[k];
      const Eigen::Matrix2d S = square - mean * mean.transpose();
      report_.nis += mean.dot(S.inverse() * mean);
      report_.nis_dof += 2;
    }
  }

  static double density(const Gaussian& g, const Eigen::Vector3d& x) {
    Eigen::Vector3d e = x - g.mean;
    e(2) = wrap(e(2));
    return std::exp(log_gaussian<3>(e, g.covariance));
  }

  static Eigen::Vector3d draw(const StepContext& context, std::uint32_t i, const Gaussian& g) {
    RngStream stream = context.stream(Draw::kernel_sample, i);
    Eigen::Vector3d eps;
    for (int k = 0; k < 3; ++k) eps(k) = stream.normal();
    Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();  // from the vehicle's frame into the map's
    ahead.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(g.mean(2)).toRotationMatrix();
    const Eigen::Matrix3d seen_ahead = ahead.transpose() * g.covariance * ahead;
    Eigen::Vector3d x = g.mean + ahead * psd_chol(seen_ahead) * eps;
    x(2) = wrap(x(2));
    return x;
  }

  /// EQUATIONS 14: landmarks seen again first.
  void learn(const StepContext& context, Scan scan) {
    WeighedPoses cloud{.pose = {}, .weight = weights()};
    for (const Gaussian& kernel : kernels_) cloud.pose.push_back(kernel.mean);
    const Pose mean = mixture(Eigen::Matrix3d::Zero()).mean;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::matched) continue;
      const std::uint32_t row = pairings_[k].landmark;
      learning_.learn(context.identity(Draw::evolution, numbers_[row]), mean.heading, cloud,
                      scan[k], *map_[row]);
    }
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::fresh) continue;
      const std::size_t row = known() ? pairings_[k].landmark : map_.size();
      map_.resize(std::max(map_.size(), row + 1));
      numbers_.resize(map_.size());
      map_[row] = learning_.initialised(cloud, mean, scan[k]);
      numbers_[row] = initialised_++;
    }
  }

  struct Moments {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  };

  MarginalSettings settings_;
  FilterSetup setup_;
  SharedMapLearning learning_;
  Eigen::Matrix2d R_, Q_;
  Eigen::Matrix3d floor_;
  std::vector<Gaussian> kernels_;  ///< grown since the last draw
  std::vector<std::uint32_t> ancestors_;
  std::vector<Pairing> pairings_;
  std::vector<Moments> predicted_;  ///< of each innovation
  Landmarks map_, believed_;
  std::vector<std::uint32_t> numbers_;  ///< {row} number of the initialisation
  std::uint32_t initialised_ = 0;       ///< so far
  ScanReport report_;
};

}  // namespace montecarta::filters::reference
