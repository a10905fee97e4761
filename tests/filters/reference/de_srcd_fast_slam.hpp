// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "tests/filters/reference/fast_slams.hpp"
#include "tests/filters/reference/sigma_fast_slams.hpp"
#include "tests/filters/reference/sigma_points.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace montecarta::filters::reference {

/// What a trial starts from (EQUATIONS 9): DE/best/1, DE/rand/1, DE/current/1.
enum class Base { best, random, target };

/// Differential evolution (EQUATIONS 9) with binomial crossover, of vectors of D numbers,
/// literally. Generation g draws for member i some blocks of a stream, which are pairs: two numbers
/// for who mates, D for who crosses.
template <int D>
class Evolution : public EvolutionRecord {
 public:
  using Member = Vector<D>;
  using Fitness = std::function<double(std::size_t member, const Member& candidate)>;

  Base base = Base::best;
  double scale = 0.4;            ///< F
  double crossover = 0.8;        ///< Cr
  std::size_t generations = 10;  ///< at most
  double tolerance = 1e-6;       ///< of fitness, at which all are equally good
  double good_enough = std::numeric_limits<double>::infinity();  ///< fitness that ends the search
  Member half = Member::Zero();                                  ///< of the box about the origin
  bool last_is_an_angle = false;                                 ///< the last component

  /// Evolves `population` and returns its best, of equals the first.
  Member best_of(std::vector<Member>& population, const StreamIdentity& chance,
                 std::uint32_t first_block, const Fitness& fitness) {
    std::vector<double> J;
    for (std::size_t i = 0; i < population.size(); ++i) J.push_back(fitness(i, population[i]));
    const std::size_t fewest = base == Base::random ? 4 : 3;
    for (std::size_t g = 0; g < generations && population.size() >= fewest; ++g) {
      const Member leader = population[leader_of(J)];
      const auto [worst, best] = std::minmax_element(J.begin(), J.end());
      if (*best - *worst < tolerance || *best >= good_enough) break;
      std::vector<Member> trials;
      for (std::size_t i = 0; i < population.size(); ++i) {
        const std::size_t block = first_block + kBlocks * (g * population.size() + i);
        trials.push_back(
            trial(population, i, leader, RngStream(chance, static_cast<std::uint32_t>(block))));
      }
      for (std::size_t i = 0; i < population.size(); ++i) {
        const double there = fitness(i, trials[i]);
        note(there - J[i], trials[i] - population[i]);
        if (there < J[i]) continue;
        population[i] = trials[i], J[i] = there;
        ++accepted;
      }
    }
    return population[leader_of(J)];
  }

 private:
  static constexpr std::size_t kBlocks = (2 + D + 1) / 2;  ///< of a stream, for one trial

  static std::size_t leader_of(const std::vector<double>& J) {
    return static_cast<std::size_t>(std::max_element(J.begin(), J.end()) - J.begin());
  }

  Member trial(const std::vector<Member>& population, std::size_t i, const Member& leader,
               RngStream draw) const {
    double first = draw.uniform(), second = draw.uniform();
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < population.size(); ++k) {
      if (k != i) others.push_back(k);
    }
    const Member plus = population[taken(others, first)];
    const Member minus = population[taken(others, first)];
    const Member other = others.empty() ? leader : population[taken(others, second)];
    const Member from = base == Base::best ? leader : base == Base::random ? other : population[i];
    const auto crosses_anyway = static_cast<Eigen::Index>(digit(second, D));
    Member offspring = population[i];
    for (Eigen::Index j = 0; j < D; ++j) {
      const bool crosses = draw.uniform() <= crossover || j == crosses_anyway;
      if (!crosses) continue;
      const bool turns = last_is_an_angle && j == D - 1;
      const double way = plus(j) - minus(j);
      offspring(j) = repaired(j, from(j) + scale * (turns ? wrap(way) : way), turns);
    }
    return offspring;
  }

  /// Reflected once at the wall, then clamped.
  double repaired(Eigen::Index j, double value, bool turns) const {
    if (turns) value = wrap(value);
    if (value > half(j)) value = 2.0 * half(j) - value;
    if (value < -half(j)) value = -2.0 * half(j) - value;
    value = std::clamp(value, -half(j), half(j));
    return turns ? wrap(value) : value;
  }

  /// A number below `count` out of a uniform one, which keeps what is left of it.
  static std::size_t digit(double& uniform, std::size_t count) {
    uniform *= static_cast<double>(count);
    const double whole = std::min(std::floor(uniform), static_cast<double>(count) - 1.0);
    uniform -= whole;
    return static_cast<std::size_t>(whole);
  }
  /// One of `others`, which it leaves.
  static std::size_t taken(std::vector<std::size_t>& others, double& uniform) {
    const std::size_t at = digit(uniform, others.size()), one = others[at];
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(at));
    return one;
  }

  /// Between a member and its likeness it does not matter what rounding decides.
  void note(double gain, const Member& way) {
    ++decisions;
    if (way.norm() < 1e-9 || gain == 0.0) return;
    closest_call = std::min(closest_call, std::abs(gain));
  }
};

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
