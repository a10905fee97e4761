// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/evolution/evolution_report.hpp"
#include "filters/population/population.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// A detection and the landmark with which a particle associates it.
template <class Real>
struct MatchedDetection {
  LandmarkGaussian<Real> landmark;
  Measurement<Real> seen;
  Real matched;  ///< 1, or 0 if the particle matches no landmark
};

/// Appends the matches of a scan for the particles of block b, which must have been fetched.
template <class Real, class Associating>
void append_matched(const Associating& association, std::size_t b,
                    std::vector<MatchedDetection<Real>>& scan) {
  for (std::size_t k = 0; k < association.matches(); ++k) {
    const auto& [landmark, seen, mask] = association.match(b, k);
    scan.push_back({landmark, seen, as_number<Real>(mask)});
  }
}

/// The fitness of a pose, given a scan.
template <class Real>
class PoseFitness {
 public:
  PoseFitness(const PoseGaussian<Real>& predicted, const SensorNoise& noise)
      : predicted_(predicted), noise_(noise) {}

  /// Log of Ankishan eq. (32) read for range and bearing, the sum of -1/2 nu' R^-1 nu (EQUATIONS
  /// (10.1)). It includes neither the motion nor the covariance of the map.
  Real likelihood(const BasicPose<Real>& pose, std::span<const MatchedDetection<Real>> scan) const {
    Real sum(0.0);
    for (const MatchedDetection<Real>& one : scan) {
      const Measurement<Real> nu = residual(one.seen, line_of_sight(pose, one.landmark.mean));
      sum += one.matched *
             (nu.first * nu.first / noise_.first + nu.second * nu.second / noise_.second);
    }
    return -0.5 * sum;
  }

  /// Log of the posterior density of the pose up to a constant, with the covariance of the map in
  /// the innovation and the prediction as prior (EQUATIONS (10.2)).
  Real posterior(const BasicPose<Real>& pose, std::span<const MatchedDetection<Real>> scan) const {
    Evidence<Real> evidence;
    for (const MatchedDetection<Real>& one : scan) {
      const LineOfSight<Real> s = line_of_sight(pose, one.landmark.mean);
      const auto use = one.matched > Real(0.5) && is_usable(s);
      const Turned<Real> map = turned(one.landmark.covariance, s);
      const auto [r, b] = residual(one.seen, s);
      const Symmetric2<Real> S{noise_.first + map.along, map.cross * s.per_range,
                               noise_.second + map.across * s.per_range * s.per_range};
      const Real determinant = S.determinant(), squared = S.adjugate_form(r, b) / determinant;
      evidence.add(select(use, squared, Real(0.0)), select(use, determinant, Real(1.0)),
                   as_number<Real>(use), one.matched);
    }
    return evidence.log_density() + predicted_(pose);
  }

 private:
  PoseDensity<Real> predicted_;
  SensorNoise noise_;
};

/// Packs the candidates of the particles of one block into full registers, so that none is spent on
/// lanes without a particle: candidate `member` of the particle in `lane` has the number member *
/// particles + lane. If all lanes have particles, nothing is moved.
template <class Real>
class PackedCandidates {
 public:
  /// `particles` <= kLanesOf<Real> particles have `members` candidates each.
  PackedCandidates(std::size_t particles, std::size_t members)
      : particles_(particles),
        numbers_(particles * members),
        lanes_of_(std::lcm(particles, kLanes)),
        place_of_(blocks_for<Real>(numbers_) * kLanes) {
    for (std::size_t i = 0; i < lanes_of_.size(); ++i)
      lanes_of_[i] = static_cast<std::uint32_t>(i % particles);
    for (std::size_t i = 0; i < place_of_.size(); ++i) {
      // Positions behind the last candidate belong to none.
      const std::size_t member = i < numbers_ ? i / particles : 0;
      place_of_[i] = static_cast<std::uint32_t>(member * kLanes + i % particles);
    }
  }

  std::size_t blocks() const { return place_of_.size() / kLanes; }
  /// Number of packed blocks after which lanes belong to the same particles again.
  std::size_t patterns() const { return lanes_of_.size() / kLanes; }

  /// Rearranges values of the particles of a block to the lanes of packed block `pattern`,
  /// `pattern` + patterns(), ... `Block` is a struct of Reals.
  template <class Block>
  Block pattern_of(const Block& particles, std::size_t pattern) const {
    if (particles_ == kLanes) return particles;
    return gather_block<Real, Block>(std::span(&particles, 1), lanes_of_, pattern);
  }
  /// Packed block q of the candidates, each of which holds one candidate per lane.
  template <class Candidate>
  Candidate pack(std::span<const Candidate> candidates, std::size_t q) const {
    if (particles_ == kLanes) return candidates[q];
    return gather_block<Real, Candidate>(candidates, place_of_, q);
  }
  /// Writes the numbers of packed block q to the positions of their candidates.
  void unpack(const Real& packed, std::size_t q, std::span<Real> numbers) const {
    if (particles_ == kLanes) {
      numbers[q] = packed;
      return;
    }
    for (std::size_t i = q * kLanes; i < std::min((q + 1) * kLanes, numbers_); ++i)
      set(numbers[place_of_[i] / kLanes], place_of_[i] % kLanes, get(packed, i % kLanes));
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  std::size_t particles_;                ///< number of lanes that hold a particle
  std::size_t numbers_;                  ///< number of candidates
  std::vector<std::uint32_t> lanes_of_;  ///< the particle of every packed lane, until they repeat
  std::vector<std::uint32_t> place_of_;  ///< member and lane of every packed candidate
};

/// The most probable poses of the particles of one block, found by evolution (EQUATIONS 10).
template <class Real>
struct MostProbable {
  std::array<Real, 3> offset{Real(0.0), Real(0.0), Real(0.0)};  ///< in standard deviations
  Real generations{0.0};  ///< number of generations until the evolution ended
  Real gain{0.0};         ///< log density of the pose found minus that of the refined mean
  std::size_t members = 0;

  /// The effect of the evolution of the particle in `lane`.
  EvolutionEffect effect(std::size_t lane) const {
    const auto [e0, e1, e2] = offset;
    return {members, get(generations, lane), get(gain, lane),
            get(sqrt(e0 * e0 + e1 * e1 + e2 * e2), lane)};
  }
};

/// Evolves a separate population for every particle of one block, in units of standard deviations
/// of the particle's refined Gaussian (EQUATIONS 10).
template <class Real>
class OwnEvolution {
 public:
  /// `population` members, at least seven, for each of the `particles` of the block.
  OwnEvolution(std::size_t particles, std::size_t population)
      : population_(population), packed_(particles, population) {}

  /// The most probable pose that is found within `bounds` standard deviations, in units of the
  /// standard deviations of `refined`, for each particle of block b. `predicted` is the prior, and
  /// `association` has the matches of the scan.
  template <class Associating>
  MostProbable<Real> most_probable(const Associating& association, std::size_t b,
                                   const PoseGaussian<Real>& predicted,
                                   const PoseGaussian<Real>& refined, const SensorNoise& noise,
                                   double bounds, const EvolutionSettings& settings,
                                   const StreamIdentity& chance) {
    look(association, b, predicted, refined, noise);
    if (scan_.empty()) return {};
    begin(bounds, chance);
    const Real bound(bounds);
    const SearchBox<Real, 3> box{{Real(0.0), Real(0.0), Real(0.0)}, {bound, bound, bound}, {}};
    // Number of blocks of the stream that begin() uses.
    const auto used = 2 * static_cast<std::uint32_t>(population_.size());
    const auto evaluation = [&](Candidates candidates, std::span<Real> fitness) {
      evaluate(candidates, fitness);
    };
    const EvolutionDraws draws{chance, used};
    const auto found = evolve<Real, 3>(population_, box, settings, draws, scratch_, evaluation);
    return {found.best, found.generations, found.gain_of_best, population_.size()};
  }

 private:
  using Candidates = std::span<const std::array<Real, 3>>;

  /// Collects Gaussians and matches of the particles of block b in the order of packed candidates.
  template <class Associating>
  void look(const Associating& association, std::size_t b, const PoseGaussian<Real>& predicted,
            const PoseGaussian<Real>& refined, const SensorNoise& noise) {
    fitness_.clear(), factors_.clear(), scan_.clear(), packed_scan_.clear();
    append_matched(association, b, scan_);
    for (std::size_t p = 0; p < packed_.patterns(); ++p) {
      fitness_.emplace_back(packed_.pattern_of(predicted, p), noise);
      factors_.emplace_back(packed_.pattern_of(refined, p));
      for (const MatchedDetection<Real>& one : scan_)
        packed_scan_.push_back(packed_.pattern_of(one, p));
    }
  }

  void evaluate(Candidates candidates, std::span<Real> fitness) const {
    const std::size_t patterns = packed_.patterns();
    for (std::size_t q = 0; q < packed_.blocks(); ++q) {
      const std::size_t p = q % patterns;
      const std::array<Real, 3> c = packed_.pack(candidates, q);
      const Real fit =
          fitness_[p].posterior(factors_[p].at(c[0], c[1], c[2]),
                                std::span(packed_scan_).subspan(p * scan_.size(), scan_.size()));
      packed_.unpack(fit, q, fitness);
    }
  }

  /// Fills the first generation with the centre, the sigma points and draws, clamped to the bounds.
  void begin(double bounds, const StreamIdentity& identity) {
    const Real bound(bounds);
    const auto inside = [&](const Real& e) {
      return select(e > bound, bound, select(e < -bound, Real(-bound), e));
    };
    population_.assign(population_.size(), {Real(0.0), Real(0.0), Real(0.0)});
    for (std::size_t j = 0; j < 3; ++j) {
      population_[1 + j][j] = inside(Real(std::sqrt(3.0)));
      population_[4 + j][j] = inside(Real(-std::sqrt(3.0)));
    }
    for (std::uint32_t i = 7; i < population_.size(); ++i) {
      const auto [e0, e1] = normal_pairs<Real>(identity, 2 * i);
      const Real e2 = normal_pairs<Real>(identity, 2 * i + 1).first;
      population_[i] = {inside(e0), inside(e1), inside(e2)};
    }
  }

  std::vector<std::array<Real, 3>> population_;
  PackedCandidates<Real> packed_;
  /// {pattern of packed lanes} fitness of the particles in the lanes.
  std::vector<PoseFitness<Real>> fitness_;
  std::vector<PoseFactor<Real>> factors_;  ///< {pattern of packed lanes} factors of their Gaussians
  std::vector<MatchedDetection<Real>> scan_;  ///< {detection} matches of the scan
  /// {pattern, detection} the matches in packed lanes.
  std::vector<MatchedDetection<Real>> packed_scan_;
  EvolutionScratch<Real, 3> scratch_;
};

/// The first population where the particles are one: their predicted poses, or poses drawn
/// uniformly within the bounds of the search (Ankishan (28)).
enum class EvolutionStart { cloud, uniform };

/// Evolves the cloud of predicted poses as one population (Ankishan 3.2, Fig. 1): member i is
/// particle i, and its fitness is evaluated with the map of particle i. Components are those along,
/// across and about the mean heading of the cloud, so that a rotated world evolves alike.
template <class Real>
class CloudEvolution {
 public:
  /// The fitness that is maximised: (10.1) or (10.2) of EQUATIONS.
  enum class Objective { likelihood, posterior };

  /// Collects the poses of the particles and their matches.
  template <class Associating>
  void gather(const StepContext& context, const Associating& association,
              const Weights<Real>& weights, const std::vector<PoseGaussian<Real>>& predicted,
              const SensorNoise& noise) {
    moments_ = mixture_of(context, weights, predicted);
    frame_ = direction_of(moments_.mean.heading);
    population_.resize(weights.particles());
    fitness_.clear(), matched_.clear();
    for (std::size_t b = 0; b < predicted.size(); ++b) {
      association.fetch(b);
      append_matched(association, b, matched_);
      fitness_.emplace_back(predicted[b], noise);
      const BasicPose<Real>& pose = predicted[b].mean;
      const Real x = pose.x - moments_.mean.x, y = pose.y - moments_.mean.y;
      const std::array<Real, 3> members{frame_.cosine * x + frame_.sine * y,
                                        frame_.cosine * y - frame_.sine * x,
                                        wrap(Real(pose.heading - moments_.mean.heading))};
      for (std::size_t i = b * kLanes; i < end_of(b); ++i)
        for (std::size_t j = 0; j < 3; ++j) population_[i][j] = get(members[j], i % kLanes);
    }
  }

  /// Evolves within `bounds` standard deviations of the cloud; replaces the predicted `poses` by
  /// the resulting ones.
  EvolutionEffect evolve(Objective objective, double bounds, EvolutionStart start,
                         const EvolutionSettings& settings, const StreamIdentity& identity,
                         std::vector<BasicPose<Real>>& poses) {
    const auto evaluate = [&](Members members, std::span<double> fitness) {
      for (std::size_t b = 0; b < fitness_.size(); ++b) {
        const Real fit = fitness_of_block(objective, b, block_of_poses(members, b));
        for (std::size_t i = b * kLanes; i < end_of(b); ++i) fitness[i] = get(fit, i % kLanes);
      }
    };
    const SearchBox<double, 3> within = box(bounds);
    EvolutionDraws draws{identity};
    if (start == EvolutionStart::uniform) scatter(within, draws);
    const auto evolved =
        filters::evolve<double, 3>(population_, within, settings, draws, scratch_, evaluate);
    double way = 0.0;
    for (std::size_t b = 0; b < poses.size(); ++b) {
      const BasicPose<Real> before = std::exchange(poses[b], block_of_poses(population_, b));
      way += sum_of_distances(b, before, poses[b]);
    }
    return {population_.size(), evolved.generations, evolved.mean_gain,
            way / static_cast<double>(population_.size())};
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;
  using Members = std::span<const std::array<double, 3>>;

  /// Draws all members uniformly within the box, Ankishan eq. (28).
  void scatter(const SearchBox<double, 3>& box, EvolutionDraws& draws) {
    for (std::array<double, 3>& member : population_) {
      const auto [first, second] = uniform_pairs(draws.identity, draws.first_block++, 0.0);
      const auto third = uniform_pairs(draws.identity, draws.first_block++, 0.0).first;
      member = {(2.0 * first - 1.0) * box.half[0], (2.0 * second - 1.0) * box.half[1],
                (2.0 * third - 1.0) * box.half[2]};
    }
  }

  /// Index after the last particle of block b.
  std::size_t end_of(std::size_t b) const { return std::min((b + 1) * kLanes, population_.size()); }

  /// Sum over the particles of block b of their distance from `before` to `after`, in standard
  /// deviations of the cloud.
  double sum_of_distances(std::size_t b, const BasicPose<Real>& before,
                          const BasicPose<Real>& after) const {
    const PoseDensity<Real> spread(
        PoseGaussian<Real>{before, in_every_lane<Real>(symmetric_of(moments_.covariance))});
    const Real distances = sqrt(spread.squared_distance(after));
    double sum = 0.0;
    for (std::size_t i = b * kLanes; i < end_of(b); ++i) sum += get(distances, i % kLanes);
    return sum;
  }

  Real fitness_of_block(Objective objective, std::size_t b, const BasicPose<Real>& pose) const {
    const std::size_t scan_size = matched_.size() / fitness_.size();
    const auto scan = std::span(matched_).subspan(b * scan_size, scan_size);
    return objective == Objective::likelihood ? fitness_[b].likelihood(pose, scan)
                                              : fitness_[b].posterior(pose, scan);
  }

  /// Poses of the particles of block b; lanes without a particle get the mean.
  BasicPose<Real> block_of_poses(Members members, std::size_t b) const {
    std::array<Real, 3> m{Real(0.0), Real(0.0), Real(0.0)};
    for (std::size_t i = b * kLanes; i < end_of(b); ++i)
      for (std::size_t j = 0; j < 3; ++j) set(m[j], i % kLanes, members[i][j]);
    return {moments_.mean.x + frame_.cosine * m[0] - frame_.sine * m[1],
            moments_.mean.y + frame_.sine * m[0] + frame_.cosine * m[1],
            wrap(Real(moments_.mean.heading + m[2]))};
  }

  /// Returns the box mean +- bounds standard deviations, enlarged to contain all members.
  SearchBox<double, 3> box(double bounds) const {
    const Symmetric3<double> P =
        turned(symmetric_of(moments_.covariance), Direction<double>{frame_.cosine, -frame_.sine});
    SearchBox<double, 3> box{
        {0.0, 0.0, 0.0},
        {bounds * std::sqrt(std::max(P.xx, 0.0)), bounds * std::sqrt(std::max(P.yy, 0.0)),
         bounds * std::sqrt(std::max(P.hh, 0.0))},
        {false, false, true}};
    for (const auto& one : population_) {
      for (std::size_t j = 0; j < 3; ++j) box.half[j] = std::max(box.half[j], std::abs(one[j]));
    }
    box.half[2] = std::min(box.half[2], kPi);
    return box;
  }

  PoseMoments moments_;
  Direction<double> frame_{1.0, 0.0};
  std::vector<MatchedDetection<Real>> matched_;  ///< {block, detection} matches of the scan
  std::vector<PoseFitness<Real>> fitness_;       ///< {block} fitness of its particles
  std::vector<std::array<double, 3>> population_;
  EvolutionScratch<double, 3> scratch_;
};

}  // namespace montecarta::filters
