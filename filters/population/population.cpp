// SPDX-License-Identifier: BSD-3-Clause
#include "filters/population/population.hpp"

#include "filters/models/ackermann.hpp"

namespace montecarta::filters {
namespace {

// The order is that of the enumerators.
const std::vector<std::string> kResamplings{"systematic", "stratified", "residual", "multinomial"};

}  // namespace

PoseMoments CloudMoments::moved_by(const MotionIncrement& increment) const {
  const Pose& step = increment.pose();
  const Point way = in_world(ahead_, step.x, step.y);  // displacement at the mean heading
  const Point mean_way = in_world(turn_, way.x, way.y);
  const Pose mean{mean_.x + mean_way.x, mean_.y + mean_way.y, wrap(mean_.heading + step.heading)};

  // A S A' with A = [I W], W = [way.x -way.y; way.y way.x; 0 0] of (cos h, sin h)
  const auto carried = [&](const Point& with_turn) {  // S_i,cs W'
    return in_world(Direction<double>{way.x, way.y}, with_turn.x, with_turn.y);
  };
  const Point x = carried(x_), y = carried(y_), h = carried(h_);
  const Point c = carried(c_), s = carried(s_);
  const Symmetric3<double> way_spread{.xx = 2.0 * x.x + way.x * c.x - way.y * s.x,
                                      .xy = x.y + y.x + way.x * c.y - way.y * s.y,
                                      .yy = 2.0 * y.y + way.y * c.y + way.x * s.y,
                                      .xh = h.x,
                                      .yh = h.y,
                                      .hh = 0.0};
  const Symmetric3<double> spread = pose_ + way_spread;

  // E[R P R'] over the particles' turns R = [cos h, -sin h; sin h, cos h] from the mean heading
  const auto& [cc, cs, ss] = turn_squares_;
  const Symmetric3<double> P = turned(increment.covariance(), ahead_);
  const Point along = in_world(turn_, P.xh, P.yh);
  const Symmetric3<double> own{.xx = cc * P.xx - 2.0 * cs * P.xy + ss * P.yy,
                               .xy = cs * (P.xx - P.yy) + (cc - ss) * P.xy,
                               .yy = ss * P.xx + 2.0 * cs * P.xy + cc * P.yy,
                               .xh = along.x,
                               .yh = along.y,
                               .hh = P.hh};
  return {mean, symmetric(spread + own)};
}

std::vector<Parameter> population_options(std::initializer_list<std::vector<Parameter>> others) {
  std::vector<Parameter> options{
      count_parameter("particles", "100", 1, 1e6, "number of particles"),
      choice_parameter("resampling", "systematic", kResamplings,
                       "resampling scheme (EQUATIONS 18)"),
      number_parameter(
          "resample_below", "0.5", 0, 1,
          "resample if the ESS is below this share of the particles; Bailey's simulator has 0.75")};
  for (const auto& more : others) options.insert(options.end(), more.begin(), more.end());
  return options;
}

PopulationSettings population_settings(const FilterOptions& options) {
  return {.particles = options.integer("particles"),
          .resampling = chosen<Resampling>(options.choice("resampling"), kResamplings),
          .resample_below = options.number("resample_below")};
}

}  // namespace montecarta::filters
