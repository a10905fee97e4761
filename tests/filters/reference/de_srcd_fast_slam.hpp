// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/evolution.hpp"
#include "tests/filters/reference/srcd_fast_slam.hpp"

namespace montecarta::filters::reference {

/// DE-SRCD-FastSLAM (EQUATIONS 10): SrcdFastSlam between its own evolution and its own weights.
class DeSrcdFastSlam : public SrcdFastSlam {
 public:
  DeSrcdFastSlam(const FastSlamSettings& settings, const SrcdParts& parts, const DeSettings& de)
      : SrcdFastSlam(settings, Weight::closed, parts), de_(de) {
    evolution_.scale = de.scale;
    evolution_.crossover = de.crossover;
    evolution_.generations = de.generations;
  }

  const EvolutionRecord& evolution() const { return evolution_; }

 private:
  using Member = Evolution<3>::Member;

  void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                      Scan scan) override {
    if (i == 0 && de_.mode != DeMode::unbiased) move_cloud(context, scan);
    const Eigen::Vector3d predicted = p.pose;
    const Eigen::Matrix3d P_predicted = p.covariance;
    if (!weighs_draws()) p.pose = centres_[i];
    const double log_closed = refine(p, scan);
    p.refined_pose = p.pose;
    p.refined_covariance = p.covariance;

    Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();
    ahead.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(p.pose(2)).toRotationMatrix();
    const Eigen::Matrix3d root = ahead * psd_chol<3>(ahead.transpose() * p.covariance * ahead);
    Eigen::Vector3d centre = p.pose;
    if (de_.mode == DeMode::shared) centre = centres_[i];
    if (de_.mode == DeMode::unbiased) {
      centre = most_probable(context.identity(Draw::evolution, i), p, root, predicted, P_predicted,
                             scan);
    }
    RngStream draw = context.stream(Draw::pose_proposal, i);
    Eigen::Vector3d eps;
    for (int k = 0; k < 3; ++k) eps(k) = draw.normal();
    const double inflation = weighs_draws() ? de_.inflation : 1.0;
    p.pose = wrapped(centre + std::sqrt(inflation) * root * eps);
    p.covariance.setZero();
    p.factor.setZero();
    if (!weighs_draws()) {
      p.log_weight += log_closed;
      return;
    }
    double log_seen = 0.0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const Landmark& landmark = *p.map[p.pairings[k].landmark];
      log_seen += log_likelihood(p.pose, landmark, scan[k]).value_or(0.0);
    }
    p.log_weight += log_seen + log_density(p.pose, predicted, P_predicted) -
                    log_density(p.pose, centre, inflation * p.refined_covariance);
  }

  bool weighs_draws() const override {
    return de_.mode == DeMode::unbiased || de_.mode == DeMode::shared;
  }

  /// Mode unbiased: a population of its own, in standard deviations of its refined Gaussian.
  Eigen::Vector3d most_probable(const StreamIdentity& chance, const Particle& p,
                                const Eigen::Matrix3d& root, const Eigen::Vector3d& predicted,
                                const Eigen::Matrix3d& P_predicted, Scan scan) {
    std::vector<Member> population{Member::Zero()};
    for (const double side : {1.0, -1.0}) {
      for (int j = 0; j < 3; ++j) population.emplace_back(side * std::sqrt(3.0) * Member::Unit(j));
    }
    for (std::uint32_t i = 7; i < de_.population; ++i) {
      RngStream draw(chance, 2 * i);
      Member one;
      for (int j = 0; j < 3; ++j) one(j) = draw.normal();
      population.push_back(one);
    }
    for (Member& one : population) one = one.cwiseMax(-de_.bounds).cwiseMin(de_.bounds);
    const auto at = [&](const Member& e) { return wrapped(p.pose + root * e); };
    evolution_.half.setConstant(de_.bounds);
    evolution_.last_is_an_angle = false;
    const auto first_block = static_cast<std::uint32_t>(2 * de_.population);
    return at(
        evolution_.best_of(population, chance, first_block, [&](std::size_t, const Member& e) {
          return log_posterior(at(e), p, predicted, P_predicted, scan);
        }));
  }

  /// The other modes: the particles are the population; its frame is the cloud's.
  void move_cloud(const StepContext& context, Scan scan) {
    centres_.clear();
    for (const Particle& p : particles_) centres_.push_back(p.pose);
    if (!somebody_matched()) return;
    const PoseMoments cloud = mixture_moments(
        particles_, [](const Particle& p) { return p.pose; },
        [](const Particle& p) { return p.covariance; });
    Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
    T.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(-cloud.mean.heading).toRotationMatrix();
    std::vector<Member> population;
    for (const auto& pose : centres_) {
      population.emplace_back(T * boxminus(as_pose(pose), cloud.mean));
    }
    Eigen::Vector3d& half = evolution_.half;
    half = de_.bounds * (T * cloud.covariance * T.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    for (const Member& one : population) half = half.cwiseMax(one.cwiseAbs());
    half(2) = std::min(half(2), kPi);
    evolution_.last_is_an_angle = true;
    const auto at = [&](const Member& e) {
      return wrapped(to_vector(cloud.mean) + T.transpose() * e);
    };
    evolution_.best_of(population, context.identity(Draw::evolution, 0), 0,
                       [&](std::size_t i, const Member& e) {
                         const Particle& p = particles_[i];
                         return de_.mode == DeMode::as_printed
                                    ? log_printed(at(e), p, scan)
                                    : log_posterior(at(e), p, p.pose, p.covariance, scan);
                       });
    for (std::size_t i = 0; i < centres_.size(); ++i) centres_[i] = at(population[i]);
  }

  bool somebody_matched() const {
    for (const Particle& p : particles_) {
      for (const Pairing& pairing : p.pairings) {
        if (pairing.kind == PairingKind::matched) return true;
      }
    }
    return false;
  }

  /// Ankishan (32), its logarithm: neither prior nor map covariance.
  double log_printed(const Eigen::Vector3d& pose, const Particle& p, Scan scan) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const Eigen::Vector2d& f = p.map[p.pairings[k].landmark]->mean;
      const Eigen::Vector2d nu = filters::to_vector(residual(
          observation_of(scan[k]), predicted_observation(as_pose(pose), Point{f(0), f(1)})));
      sum -= 0.5 * nu.dot(R_.inverse() * nu);
    }
    return sum;
  }

  /// J of EQUATIONS (10.2): log p(pose) p(scan given pose), the map uncertain.
  double log_posterior(const Eigen::Vector3d& pose, const Particle& p,
                       const Eigen::Vector3d& predicted, const Eigen::Matrix3d& P_predicted,
                       Scan scan) const {
    double sum = log_density(pose, predicted, P_predicted);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(pose, *p.map[p.pairings[k].landmark], scan[k], R_);
      if (seen) sum += log_gaussian<2>(seen->nu, seen->S_f);
    }
    return sum;
  }

  static double log_density(const Eigen::Vector3d& pose, const Eigen::Vector3d& mean,
                            const Eigen::Matrix3d& P) {
    const Eigen::Matrix3d floor = Eigen::Vector3d(1e-12, 1e-12, 1e-14).asDiagonal();
    const Eigen::Matrix3d S = P + floor;
    return log_gaussian<3>(boxminus(as_pose(pose), as_pose(mean)), S);
  }
  static Eigen::Vector3d wrapped(Eigen::Vector3d pose) {
    pose(2) = wrap(pose(2));
    return pose;
  }

  DeSettings de_;
  Evolution<3> evolution_;
  std::vector<Eigen::Vector3d> centres_;  ///< where the cloud moved to
};

}  // namespace montecarta::filters::reference
