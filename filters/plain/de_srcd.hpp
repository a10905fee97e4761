// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/evolution.hpp"
#include "filters/plain/srcd.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters::plain {

/// DE-SRCD-FastSLAM (EQUATIONS 10; Ankishan et al. 2016, 3.2): SRCD-FastSLAM with poses that are
/// moved by differential evolution before or after they are refined.
class DeSrcd final : public Srcd {
 public:
  explicit DeSrcd(const FilterSetup& setup)
      : Srcd(setup, {}, "closed"),
        mode_(setup.options.choice("mode")),
        starts_uniformly_(setup.options.choice("start") == "uniform"),
        population_(setup.options.integer("population")),
        bounds_(setup.options.number("bounds")),
        inflation_(setup.options.number("inflation")) {
    evolution_.settings = {
        .scale = setup.options.number("scale"),
        .crossover = setup.options.number("crossover"),
        .generations = setup.options.integer("generations"),
        .base = chosen<EvolutionBase>(setup.options.choice("base"), kEvolutionBases)};
  }

  const Evolution<3>& evolution() const { return evolution_; }

 private:
  using Member = Vector<3>;

  bool weighs_draws() const override { return mode_ == "unbiased" || mode_ == "shared"; }

  void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                      Scan scan) override {
    if (i == 0 && mode_ != "unbiased") move_cloud(context, scan);
    const Particle predicted = p;
    if (!weighs_draws()) p.pose = moved_[i];
    const double log_closed = refine(p, scan);
    const Matrix<3> root = root_along(p.pose(2), p.covariance);
    Vector<3> centre = p.pose;
    if (mode_ == "shared") centre = moved_[i];
    if (mode_ == "unbiased")
      centre = most_probable(context.identity(Draw::evolution, i), p, root, predicted, scan);
    const double inflation = weighs_draws() ? inflation_ : 1.0;
    place(p,
          drawn_from(centre, std::sqrt(inflation) * root, context.stream(Draw::pose_proposal, i)));
    p.log_weight += weighs_draws() ? log_ratio(p, predicted, centre, inflation, scan) : log_closed;
  }

  /// Mode unbiased: the best member of a population of its own, in standard deviations of the
  /// refined Gaussian.
  Vector<3> most_probable(const StreamIdentity& chance, Particle& p, const Matrix<3>& root,
                          const Particle& predicted, Scan scan) {
    std::vector<Member> population{Member::Zero()};
    for (const double side : {1.0, -1.0}) {
      for (int j = 0; j < 3; ++j) population.emplace_back(side * std::sqrt(3.0) * Member::Unit(j));
    }
    for (std::uint32_t i = 7; i < population_; ++i) {
      RngStream draw(chance, 2 * i);
      Member member;
      for (double& one : member) one = draw.normal();
      population.push_back(member);
    }
    for (Member& one : population) one = one.cwiseMax(-bounds_).cwiseMin(bounds_);
    const auto at = [&](const Member& e) { return wrapped(p.pose + root * e); };
    evolution_.half.setConstant(bounds_);
    evolution_.last_is_an_angle = false;
    const auto first_block = static_cast<std::uint32_t>(2 * population_);
    return at(
        evolution_.best_of(population, chance, first_block, [&](std::size_t, const Member& e) {
          return log_posterior(at(e), p, predicted.pose, predicted.covariance, scan);
        }));
  }

  /// The other modes: the particles are the population, along, across and about the mean heading.
  void move_cloud(const StepContext& context, Scan scan) {
    moved_.clear();
    for (const Particle& p : particles_) moved_.push_back(p.pose);
    if (!anything_matched()) return;
    const PoseMoments cloud = mixture_moments(
        particles_, [](const Particle& p) { return p.pose; },
        [](const Particle& p) { return p.covariance; });
    Matrix<3> T = Matrix<3>::Identity();
    T.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(-cloud.mean.heading).toRotationMatrix();
    std::vector<Member> population;
    for (const Vector<3>& pose : moved_)
      population.emplace_back(T * boxminus(as_pose(pose), cloud.mean));
    Member& half = evolution_.half;
    half = bounds_ * (T * cloud.covariance * T.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    for (const Member& one : population) half = half.cwiseMax(one.cwiseAbs());
    half(2) = std::min(half(2), kPi);
    std::uint32_t first_block = 0;
    if (starts_uniformly_) {
      for (Member& one : population) {
        RngStream draw(context.identity(Draw::evolution, 0), first_block);
        for (Eigen::Index j = 0; j < 3; ++j) one(j) = (2.0 * draw.uniform() - 1.0) * half(j);
        first_block += 2;
      }
    }
    evolution_.last_is_an_angle = true;
    const auto at = [&](const Member& e) {
      return wrapped(to_vector(cloud.mean) + T.transpose() * e);
    };
    evolution_.best_of(population, context.identity(Draw::evolution, 0), first_block,
                       [&](std::size_t i, const Member& e) {
                         Particle& p = particles_[i];
                         return mode_ == "as_printed"
                                    ? log_printed(at(e), p, scan)
                                    : log_posterior(at(e), p, p.pose, p.covariance, scan);
                       });
    for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i] = at(population[i]);
  }

  bool anything_matched() const {
    return std::ranges::any_of(particles_, [](const Particle& p) {
      return std::ranges::count(p.pairings, PairingKind::matched, &Pairing::kind) > 0;
    });
  }

  /// EQUATIONS (10.1), the logarithm of Ankishan (32): without prior and covariance of the map.
  double log_printed(const Vector<3>& pose, Particle& p, Scan scan) const {
    double sum = 0.0;
    for_each_match(p, scan, [&](const Landmark& landmark, std::size_t k) {
      const Point place{landmark.mean(0), landmark.mean(1)};
      const auto h = predicted_observation(as_pose(pose), place);
      sum -= 0.5 * squared_distance(difference(scan[k], filters::to_vector(h)), R_);
    });
    return sum;
  }

  /// EQUATIONS (10.2): log p(pose) p(scan given pose), with an uncertain map.
  double log_posterior(const Vector<3>& pose, Particle& p, const Vector<3>& predicted,
                       const Matrix<3>& P, Scan scan) const {
    double sum = log_density(pose, predicted, P);
    for_each_match(p, scan, [&](const Landmark& landmark, std::size_t k) {
      sum += log_density_of(linearised_innovation(pose, landmark, scan[k]));
    });
    return sum;
  }

  static Vector<3> wrapped(Vector<3> pose) {
    pose(2) = wrap(pose(2));
    return pose;
  }

  std::string mode_;
  bool starts_uniformly_;  ///< in modes other than unbiased
  std::size_t population_;
  double bounds_;     ///< of the search, in standard deviations
  double inflation_;  ///< of the covariance that poses are drawn from
  Evolution<3> evolution_;
  std::vector<Vector<3>> moved_;  ///< {particle} centre to which evolution moved it
};

}  // namespace montecarta::filters::plain
