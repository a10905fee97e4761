// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_options.hpp"
#include "tests/filters/reference/de_srcd_fast_slam.hpp"
#include "tests/filters/reference/particle.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <vector>

namespace montecarta::filters::reference {

/// Poses and their weights, which sum to one.
struct WeighedPoses {
  std::vector<Eigen::Vector3d> pose;
  std::vector<double> weight;
};

/// How a landmark of the one map learns from a detection made from all poses, as EQUATIONS 14
/// writes it, in plain Eigen: by evolution, or by Gauss-Newton with numerical care left out.
class SharedMapLearning {
 public:
  SharedMapLearning(const MapSettings& settings, const Belief& belief)
      : settings_(settings), belief_(belief) {
    R_ = Eigen::Vector2d(std::pow(belief.sigma_range, 2), std::pow(belief.sigma_bearing, 2))
             .asDiagonal();
    evolution_.base = static_cast<Base>(settings.evolution.base);
    evolution_.scale = settings.evolution.scale;
    evolution_.crossover = settings.evolution.crossover;
    evolution_.generations = settings.evolution.generations;
    if (settings.mode == MapMode::onestep_threshold) evolution_.good_enough = -settings.threshold;
  }

  /// theta = Sum w g(s, z), Lambda as seen from the mean pose.
  Landmark initialised(const WeighedPoses& cloud, const Pose& mean,
                       const Detection& detection) const {
    Landmark landmark = new_landmark({mean.x, mean.y, mean.heading}, detection, R_);
    landmark.mean.setZero();
    for (std::size_t i = 0; i < cloud.pose.size(); ++i)
      landmark.mean += cloud.weight[i] * new_landmark(cloud.pose[i], detection, R_).mean;
    return landmark;
  }

  /// `heading`: candidates are scattered ahead of it and to its left.
  void learn(const StreamIdentity& chance, double heading, const WeighedPoses& cloud,
             const Detection& detection, Landmark& landmark) {
    Known known{landmark.mean, Eigen::Matrix2d::Zero()};
    if (settings_.mode == MapMode::recursive) known.information = landmark.covariance.inverse();
    if (settings_.mode == MapMode::onestep_threshold &&
        objective(landmark.mean, cloud, detection) <= settings_.threshold) {
      ++left_alone_;
      return;
    }
    landmark.mean = settings_.solver == MapSolver::de
                        ? evolved_place(chance, heading, cloud, detection, known)
                        : gauss_newton_place(cloud, detection, known);
    Eigen::Matrix2d information = known.information;
    for (std::size_t i = 0; i < cloud.pose.size(); ++i) {
      const Eigen::Matrix2d Hf = seen_from(cloud.pose[i], landmark, detection, R_)->Hf;
      information += cloud.weight[i] * Hf.transpose() * R_.inverse() * Hf;
    }
    landmark.covariance = information.inverse();
  }

  const Evolution<2>& evolution() const { return evolution_; }
  /// Landmarks in the dead zone of EQUATIONS 14, so far.
  std::size_t left_alone() const { return left_alone_; }

 private:
  /// What is known before the detection: theta and Lambda.
  struct Known {
    Eigen::Vector2d mean;
    Eigen::Matrix2d information;
  };

  /// nu' R^-1 nu.
  double squared(const Eigen::Vector3d& pose, const Eigen::Vector2d& place,
                 const Detection& detection) const {
    const Eigen::Vector2d nu =
        to_vector(residual(observation_of(detection),
                           predicted_observation(as_pose(pose), Point{place(0), place(1)})));
    return nu.dot(R_.inverse() * nu);
  }

  /// -2 log Sum w exp(-nu' R^-1 nu / 2), or a mean of squares (EQUATIONS 14).
  double objective(const Eigen::Vector2d& place, const WeighedPoses& cloud,
                   const Detection& detection) const {
    double mean = 0.0, printed = 0.0;
    std::vector<double> log_terms;
    for (std::size_t i = 0; i < cloud.pose.size(); ++i) {
      const double one = squared(cloud.pose[i], place, detection);
      log_terms.push_back(std::log(cloud.weight[i]) - 0.5 * one);
      mean += cloud.weight[i] * one;
      printed += one / static_cast<double>(cloud.pose.size());
    }
    if (settings_.objective == MapObjective::squares) return mean;
    if (settings_.objective == MapObjective::squares_as_printed) return printed;
    const double peak = *std::max_element(log_terms.begin(), log_terms.end());
    double sum = 0.0;
    for (const double term : log_terms) sum += std::exp(term - peak);
    return -2.0 * (peak + std::log(sum));
  }

  /// EQUATIONS 14.
  Eigen::Vector2d evolved_place(const StreamIdentity& chance, double heading,
                                const WeighedPoses& cloud, const Detection& detection,
                                const Known& known) {
    const double half = 3.0 * std::max(belief_.sigma_range, detection[0] * belief_.sigma_bearing);
    std::vector<Eigen::Vector2d> population(settings_.population, Eigen::Vector2d::Zero());
    for (std::uint32_t k = 1; k < population.size(); ++k) {
      RngStream draw(chance, k);
      for (int axis = 0; axis < 2; ++axis)
        population[k](axis) = half * (2.0 * draw.uniform() - 1.0);
    }
    const Eigen::Matrix2d ahead = Eigen::Rotation2D<double>(heading).toRotationMatrix();
    evolution_.half.setConstant(half);
    const Eigen::Vector2d best =
        evolution_.best_of(population, chance, static_cast<std::uint32_t>(population.size()),
                           [&](std::size_t, const Eigen::Vector2d& offset) {
                             const Eigen::Vector2d way = ahead * offset;
                             return -(objective(known.mean + way, cloud, detection) +
                                      way.dot(known.information * way));
                           });
    return known.mean + ahead * best;
  }

  /// EQUATIONS 14 by Newton's method with the Gauss-Newton matrix, until it rests.
  Eigen::Vector2d gauss_newton_place(const WeighedPoses& cloud, const Detection& detection,
                                     const Known& known) const {
    Landmark at{.mean = known.mean, .covariance = Eigen::Matrix2d::Zero()};
    for (int k = 0; k < 30; ++k) {
      Eigen::Matrix2d A = known.information;
      Eigen::Vector2d g = -known.information * (at.mean - known.mean);
      for_each_share(at, cloud, detection, [&](double share, const Seen& seen) {
        A += share * seen.Hf.transpose() * R_.inverse() * seen.Hf;
        g += share * seen.Hf.transpose() * R_.inverse() * seen.nu;
      });
      at.mean += A.inverse() * g;
    }
    return at.mean;
  }

  void for_each_share(const Landmark& at, const WeighedPoses& cloud, const Detection& detection,
                      const std::function<void(double, const Seen&)>& visit) const {
    double total = 0.0;
    std::vector<double> share = cloud.weight;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (settings_.objective == MapObjective::squares_as_printed) share[i] = 1.0;
      if (settings_.objective == MapObjective::likelihood)
        share[i] *= std::exp(-0.5 * squared(cloud.pose[i], at.mean, detection));
      total += share[i];
    }
    for (std::size_t i = 0; i < share.size(); ++i)
      visit(share[i] / total, *seen_from(cloud.pose[i], at, detection, R_));
  }

  MapSettings settings_;
  Belief belief_;
  Eigen::Matrix2d R_;
  Evolution<2> evolution_;
  std::size_t left_alone_ = 0;
};

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
