// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_search.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/fitted_minimum.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace montecarta::experiments {
namespace {

/// Octaves of the first grid on each side of its centre.
constexpr int kGridSides = 3;
/// Number of first runs by which the minimum is searched before surfaces are fitted.
constexpr std::uint64_t kRunsOfSearch = 32;
constexpr int kMostMoves = 40;

using Axes = std::array<bool, 2>;

/// The least of `points`, of equal ones the first.
LatticePoint least_of(const NoiseLandscape& landscape, const std::vector<LatticePoint>& points,
                      std::uint64_t runs, const Intervals& intervals) {
  return *std::ranges::min_element(points, {}, [&](const LatticePoint& point) {
    return landscape.mean(point, runs, intervals);
  });
}

/// The square grid about `centre` with `sides` steps on each side, cut at the end of the lattice.
/// An axis that is not free has one place.
std::vector<LatticePoint> grid_about(const LatticePoint& centre, int sides, int step,
                                     const Axes& is_free) {
  std::vector<LatticePoint> points;
  const int motions = is_free[0] ? sides : 0, sensors = is_free[1] ? sides : 0;
  for (int i = -motions; i <= motions; ++i) {
    for (int j = -sensors; j <= sensors; ++j) {
      const LatticePoint point{centre.motion + i * step, centre.sensor + j * step};
      if (std::max(std::abs(point.motion), std::abs(point.sensor)) <= kFarthest)
        points.push_back(point);
    }
  }
  return points;
}

/// Multiplies the standard errors by `apart` and the reach of the intervals by `reach`.
void widen(double apart, double reach, TunedNoise& noise) {
  noise.motion_apart *= apart;
  noise.sensor_apart *= apart;
  for (TunedFactor* factor : {&noise.motion, &noise.sensor}) {
    factor->interval.lower =
        factor->value * std::pow(factor->interval.lower / factor->value, reach);
    factor->interval.upper =
        factor->value * std::pow(factor->interval.upper / factor->value, reach);
  }
}

/// A search on one landscape by some prediction intervals.
class NoiseSearch {
 public:
  NoiseSearch(NoiseLandscape& landscape, Intervals intervals, const Axes& is_free)
      : landscape_(&landscape), intervals_(std::move(intervals)), is_free_(is_free) {}

  /// Moves to the least neighbour at `step` until there is none.
  LatticePoint descend(LatticePoint centre, int sides, int step) const {
    const std::uint64_t runs = std::min(kRunsOfSearch, landscape_->runs());
    for (int move = 0; move < kMostMoves; ++move) {
      const auto points = grid_about(centre, sides, step, is_free_);
      landscape_->compute(points, runs);
      const LatticePoint least = least_of(*landscape_, points, runs, intervals_);
      if (!std::isfinite(landscape_->mean(least, runs, intervals_))) return centre;
      const bool is_inside = std::max(std::abs(least.motion - centre.motion),
                                      std::abs(least.sensor - centre.sensor)) < sides * step;
      if (least == centre || (sides > 1 && is_inside)) return least;
      centre = least;
    }
    return centre;
  }

  /// The minimum of a surface that is fitted near `centre`; nullopt if there is none.
  std::optional<TunedNoise> fitted_near(const LatticePoint& centre) const {
    for (const int step : {1, 2, 4}) {
      if (const auto found = fitted_near(centre, step)) return found;
    }
    return std::nullopt;
  }

 private:
  std::optional<TunedNoise> fitted_near(LatticePoint centre, int step) const {
    constexpr double kNearCentre = 0.75;  // steps; half a step is reached by rounding
    for (int move = 0; move < kMostMoves; ++move) {
      const auto values = values_about(centre, step);
      if (!values) return std::nullopt;
      const FittedMinimum found = fitted_minimum(*values, is_free_);
      const bool is_near = found.place.cwiseAbs().maxCoeff() <= kNearCentre;
      if (is_near) {
        if (!found.is_minimum) return std::nullopt;
        return noise_at(found, centre, step);
      }
      centre.motion += step * static_cast<int>(std::lround(found.place.x()));
      centre.sensor += step * static_cast<int>(std::lround(found.place.y()));
    }
    return std::nullopt;
  }

  /// {kGridPlaces, part} Shares of the parts in the scores about `centre`; nullopt if the filter
  /// fails at one of them, or if the lattice ends.
  std::optional<Eigen::MatrixXd> values_about(const LatticePoint& centre, int step) const {
    const auto points = grid_about(centre, kGridReach, step, {true, true});
    if (points.size() < kGridPlaces) return std::nullopt;
    std::vector<LatticePoint> used;
    for (const LatticePoint& point : points) {
      used.push_back(
          {is_free_[0] ? point.motion : centre.motion, is_free_[1] ? point.sensor : centre.sensor});
    }
    landscape_->compute(used, landscape_->runs());
    Eigen::MatrixXd values(kGridPlaces, static_cast<Eigen::Index>(landscape_->parts()));
    for (std::size_t row = 0; row < used.size(); ++row) {
      if (!std::isfinite(landscape_->mean(used[row], landscape_->runs(), intervals_)))
        return std::nullopt;
      const std::vector<double> shares = landscape_->shares(used[row], intervals_);
      for (std::size_t part = 0; part < shares.size(); ++part)
        values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(part)) = shares[part];
    }
    return values;
  }

  TunedFactor factor_of(double logarithm, double variance, bool is_free) const {
    if (!is_free) return {1.0, {kNaN, kNaN}};
    const double reach =
        t_of_samples(static_cast<double>(landscape_->parts())) * std::sqrt(variance);
    return {std::exp(logarithm), {std::exp(logarithm - reach), std::exp(logarithm + reach)}};
  }

  TunedNoise noise_at(const FittedMinimum& found, const LatticePoint& centre, int step) const {
    const double unit = step * std::numbers::ln2 / kOctave;
    const double per_place = std::numbers::ln2 / kOctave;
    const Eigen::Matrix2d covariance = unit * unit * found.covariance;
    TunedNoise noise;
    noise.motion = factor_of(per_place * centre.motion + unit * found.place.x(), covariance(0, 0),
                             is_free_[0]);
    noise.sensor = factor_of(per_place * centre.sensor + unit * found.place.y(), covariance(1, 1),
                             is_free_[1]);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
    const Eigen::Vector2d longest =
        std::sqrt(std::max(axes.eigenvalues()[1], 0.0)) * axes.eigenvectors().col(1);
    const double sign = longest[std::abs(longest[0]) >= std::abs(longest[1]) ? 0 : 1] < 0 ? -1 : 1;
    noise.motion_apart = sign * longest[0];
    noise.sensor_apart = sign * longest[1];
    return noise;
  }

  NoiseLandscape* landscape_;
  Intervals intervals_;
  Axes is_free_;
};

/// Returns on which factors the score depends. Where the filter fails, that is not known, and the
/// factors are searched.
Axes free_axes(NoiseLandscape& landscape, std::uint64_t runs) {
  const LatticePoint here, motion{kOctave, 0}, sensor{0, kOctave};
  landscape.compute(std::array{here, motion, sensor}, runs);
  const auto mean = [&](const LatticePoint& point) {
    return landscape.mean(point, runs, landscape.intervals());
  };
  const auto has_failed = [&](const LatticePoint& point) {
    return landscape.has_failed(point, runs, landscape.intervals());
  };
  const auto is_free = [&](const LatticePoint& point) {
    return mean(point) != mean(here) || (has_failed(here) && has_failed(point));
  };
  return {is_free(motion), is_free(sensor)};
}

NoiseGrid grid_of(NoiseLandscape& landscape, const LatticePoint& centre, const Axes& is_free) {
  const std::uint64_t runs = std::min(kRunsOfSearch, landscape.runs());
  const auto points = grid_about(centre, kGridSides, kOctave, is_free);
  landscape.compute(points, runs);
  NoiseGrid grid;
  for (const LatticePoint& point : points) {
    const NoiseFactors factors = factors_at(point);
    if (grid.motion.empty() || grid.motion.back() != factors.motion) {
      grid.motion.push_back(factors.motion);
      grid.score.emplace_back();
    }
    if (grid.motion.size() == 1) grid.sensor.push_back(factors.sensor);
    grid.score.back().push_back(landscape.mean(point, runs, landscape.intervals()));
  }
  return grid;
}

std::string factors_text(const LatticePoint& point) {
  return formatted("a factor of {} on motion and {} on sensor", readable(factor_at(point.motion)),
                   readable(factor_at(point.sensor)));
}

/// What helps if a score has no minimum.
std::string remedy_for_no_minimum(std::size_t outliers) {
  if (outliers == 0)
    return "use more runs or a longer drive, or check the other settings of [belief]";
  return formatted(
      "{} of the fixes {}: leave wrong ones out of the reference, or give them the "
      "sigmas that they really have",
      outliers, outliers == 1 ? "is a gross outlier" : "are gross outliers");
}

[[noreturn]] void refuse_no_minimum(const CellSpec& cell, const LatticePoint& least,
                                    const Axes& is_free, std::size_t outliers) {
  const bool is_at_end = std::max(std::abs(least.motion), std::abs(least.sensor)) == kFarthest;
  const std::string why = is_at_end ? "it falls as far as factors of 64"
                          : is_free[0] && is_free[1]
                              ? "no surface fits it, or the filter fails near by"
                              : "the filter fails near by";
  throw StudyError("{}: cell {}: its score has no minimum near {} ({}): {}", cell.place, cell.label,
                   factors_text(least), why, remedy_for_no_minimum(outliers));
}

/// Widens the intervals for `effective` independent samples, if they are fewer than the parts: the
/// errors then last longer than a part (STATISTICS 23). If no error could be judged, it counts as
/// one.
void take_memory(double effective, TuningResult& result) {
  const auto parts = static_cast<double>(result.parts);
  result.effective = effective;
  if (effective >= parts) return;
  effective = std::max(effective, 1.0);
  const double apart = std::sqrt(parts / effective);
  const double reach = apart * t_of_samples(effective) / t_of_samples(parts);
  widen(apart, reach, result.noise);
  for (TunedByInterval& one : result.by_interval) {
    if (one.noise) widen(apart, reach, *one.noise);
  }
}

}  // namespace

TuningResult find_noise(const Study& study, const CellSpec& cell, TuningScore score,
                        const Parallel& parallel) {
  NoiseLandscape landscape(study, cell, score, parallel);
  const Axes is_free = free_axes(landscape, std::min(kRunsOfSearch, landscape.runs()));
  if (!is_free[0] && !is_free[1]) {
    throw StudyError(
        "{}: cell {} has the same score with any noise (it assumes none, or nothing is {}): tune a "
        "filter that uses the noise of [belief]",
        cell.place, cell.label, score == TuningScore::innovations ? "predicted" : "scored");
  }
  const NoiseSearch search(landscape, landscape.intervals(), is_free);
  const LatticePoint octave = search.descend({}, kGridSides, kOctave);
  const LatticePoint least = search.descend(search.descend(octave, 1, 4), 1, 2);
  const auto noise = search.fitted_near(least);
  if (!noise) refuse_no_minimum(cell, least, is_free, landscape.outliers());
  TuningResult result{.cell = cell.label,
                      .score = score,
                      .runs = landscape.runs(),
                      .has_gate = study.settings.text("association", "kind") == "nearest",
                      .parts = landscape.parts(),
                      .fixes = landscape.fixes(),
                      .outliers = landscape.outliers(),
                      .noise = *noise,
                      .grid = grid_of(landscape, octave, is_free)};
  for (const std::size_t interval : landscape.intervals()) {
    const NoiseSearch alone(landscape, {interval}, is_free);
    const LatticePoint near = alone.descend(alone.descend(least, 1, 4), 1, 2);
    result.by_interval.push_back({kPredictionIntervals[interval], alone.fitted_near(near)});
  }
  take_memory(landscape.effective_samples(least), result);
  return result;
}

}  // namespace montecarta::experiments
