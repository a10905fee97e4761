// SPDX-License-Identifier: BSD-3-Clause
// Anchored landmarks correlated with a pose that is not drawn.
#include "filters/moments/correlated_anchored.hpp"

#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/correlated_birth.hpp"
#include "filters/moments/correlated_draw.hpp"
#include "filters/moments/moment_transforms.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/sigma_models.hpp"
#include "tests/filters/reference/square_root.hpp"

#include <gtest/gtest.h>

namespace montecarta {
namespace {

using reference::Vector;
template <int N>
using Square = Eigen::Matrix<double, N, N>;
using Anchoreds = CorrelatedMap<double, AnchoredLandmark<double>>;

const double kInterval = std::sqrt(3.0);

SigmaPoints central() {
  const SigmaRule rule = central_difference_rule(kInterval);
  return SigmaPoints({rule, rule, rule}, Belief{}, MapUncertainty::on);
}

/// What a map of two landmarks holds: pose, then coordinates.
template <class Map, class Mean>
Vector<7> mean_of(const Map& map, const Mean& mean) {
  const auto& x = map.pose(0).mean;
  Vector<7> all;
  all << x.x, x.y, x.heading, mean(map.landmark(0, 0)), mean(map.landmark(1, 0));
  return all;
}
template <class Map>
Square<7> covariance_of(const Map& map) {
  Square<7> P = Square<7>::Zero();
  P.topLeftCorner<3, 3>() = symmetric(map.pose(0).covariance);
  for (int i = 0; i < 2; ++i) {
    const auto k = static_cast<std::size_t>(i);
    P.block<2, 2>(3 + 2 * i, 3 + 2 * i) = symmetric(own_covariance(map.landmark(k, 0)));
    const auto& [x, y] = map.pose_cross(k, 0);
    P.block<2, 3>(3 + 2 * i, 0) << x.x, x.y, x.h, y.x, y.y, y.h;
  }
  const auto& c = map.map_cross(1, 0, 0);
  P.block<2, 2>(5, 3) << c.xx, c.xy, c.yx, c.yy;
  return P.selfadjointView<Eigen::Lower>();
}
/// Fills pose, crosses and the landmarks' own covariances.
template <class Map, class Set>
void fill(Map& map, const Pose& pose, const Square<7>& P, const Set& set) {
  map.add(), map.add();
  map.pose(0) = {pose, symmetric_of(P.topLeftCorner<3, 3>())};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto r = static_cast<Eigen::Index>(3 + 2 * i);
    set(map.landmark(i, 0), Symmetric2<double>{P(r, r), P(r, r + 1), P(r + 1, r + 1)});
    map.pose_cross(i, 0) = {{P(r, 0), P(r, 1), P(r, 2)}, {P(r + 1, 0), P(r + 1, 1), P(r + 1, 2)}};
  }
  map.map_cross(1, 0, 0) = {P(5, 3), P(5, 4), P(6, 3), P(6, 4)};
}

/// A pose and two anchored landmarks, all correlated; and the same as Gaussians in the map.
struct TwoOfAKind {
  RandomSight sight;
  Anchoreds anchored{1};
  CorrelatedMap<double> in_place{1};
  Square<7> G = Square<7>::Identity();  ///< from anchored coordinates to the map

  explicit TwoOfAKind(RngStream& draw) : sight(draw) {
    Square<7> A;
    for (double& value : A.reshaped()) value = draw.normal();
    Vector<7> scale;
    scale << 0.5, 0.5, 0.05, 0.8, 0.04, 0.8, 0.04;
    const Square<7> P = scale.asDiagonal() * A * A.transpose() * scale.asDiagonal();
    fill(anchored, sight.pose.mean, P, [&](auto& landmark, const Symmetric2<double>& own) {
      landmark.anchor = {sight.pose.mean.x + draw.normal(), sight.pose.mean.y + draw.normal(),
                         wrap(7.0 * draw.normal())};
      landmark.mean = {20.0 + 15.0 * draw.uniform(), 3.0 * draw.normal()};
      landmark.rr = own.xx, landmark.rb = own.xy, landmark.bb = own.yy;
    });
    for (int i = 0; i < 2; ++i) {
      const auto& q = anchored.landmark(static_cast<std::size_t>(i), 0);
      G.block<2, 2>(3 + 2 * i, 3 + 2 * i) = sight_jacobian(linearised_place(q.anchor, q.mean));
    }
    std::size_t next = 0;
    fill(in_place, sight.pose.mean, G * P * G.transpose(),
         [&](auto& landmark, const Symmetric2<double>& own) {
           const auto& q = anchored.landmark(next++, 0);
           landmark = {linearised_place(q.anchor, q.mean).point, own};
         });
    const auto expected = predicted_sight(sight.pose.mean, in_place.landmark(1, 0).mean);
    sight.seen = {expected.range + draw.normal(), wrap(expected.bearing + 0.05 * draw.normal())};
  }
  Vector<7> anchored_mean() const {
    return mean_of(anchored, [](const auto& q) { return to_vector(q.mean); });
  }
  Vector<7> mean_in_place() const {
    return mean_of(in_place, [](const auto& f) { return to_vector(f.mean); });
  }
};

/// An update sees the Gaussian that the landmark nearly is in the map; its own coordinates follow
/// linearly.
template <class Transform>
void expect_sights_alike(const Transform& transform, std::uint64_t seed) {
  RngStream draw({.seed = seed, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    TwoOfAKind c(draw);
    const Vector<7> q = c.anchored_mean(), f = c.mean_in_place();
    Evidence<double> one, other;
    const auto& [seen, noise] = std::pair(c.sight.seen, c.sight.noise);
    absorb(c.anchored, 0, ForAll{1}, transform, seen, noise, Everywhere(), one);
    absorb(c.in_place, 0, ForAll{1}, transform, seen, noise, Everywhere(), other);
    Vector<7> apart = c.G * (c.anchored_mean() - q) - (c.mean_in_place() - f);
    apart(2) = wrap(apart(2));
    EXPECT_LT(apart.norm(), 1e-9) << "case " << n;
    const Square<7> P = c.G * covariance_of(c.anchored) * c.G.transpose();
    EXPECT_LT((P - covariance_of(c.in_place)).norm(), 1e-9) << "case " << n;
    EXPECT_NEAR(one.log_density(), other.log_density(), 1e-9) << "case " << n;
  }
}

TEST(CorrelatedAnchored, ASightIsThatOfTheGaussianInTheMap) {
  expect_sights_alike(Linearised(), 301);
  expect_sights_alike(central(), 302);
}

TEST(CorrelatedAnchored, ADrawnPoseConditionsTheOneAsTheOther) {
  RngStream draw({.seed = 303, .purpose = Draw::test});
  for (int n = 0; n < 100; ++n) {
    TwoOfAKind c(draw);
    const PoseGaussian<double> pose = c.anchored.pose(0);
    const KnownPose<double> known(pose, {pose.mean.x + 0.3 * draw.normal(), pose.mean.y - 0.2,
                                         wrap(pose.mean.heading + 0.05 * draw.normal())});
    const auto q = c.anchored.landmark(0, 0);
    const auto given = known.condition(q, c.anchored.pose_cross(0, 0));
    const auto f = c.in_place.landmark(0, 0);
    const auto expected = known.condition(f, c.in_place.pose_cross(0, 0));
    const Eigen::Matrix2d Gz = c.G.block<2, 2>(3, 3);
    EXPECT_LT((Gz * (to_vector(given.mean) - to_vector(q.mean)) - to_vector(expected.mean) +
               to_vector(f.mean))
                  .norm(),
              1e-9);
    EXPECT_LT(
        (Gz * symmetric(own_covariance(given)) * Gz.transpose() - symmetric(expected.covariance))
            .norm(),
        1e-9);
    EXPECT_EQ(given.anchor.x, q.anchor.x);
    EXPECT_EQ(given.anchor.heading, q.anchor.heading);
  }
}

/// What the anchor has to see for the landmark to stand where pose and detection say.
struct SeenFromAnchor {
  Pose anchor;
  Vector<2> operator()(const Vector<5>& x) const {
    const Vector<2> f = reference::PlaceModel{Pose{x(0), x(1), x(2)}}(x.tail<2>());
    return to_vector(predicted_sight(anchor, Point{f(0), f(1)}));
  }
};

/// A landmark born of an uncertain pose by all points of a central difference, whose square root
/// has first heading plus bearing, then the pose's place across the ray.
struct BornByAllPoints {
  Vector<2> mean;
  Square<2> covariance;
  Eigen::Matrix<double, 3, 2> cross;

  BornByAllPoints(const RandomSight& c, double interval, const SensorNoise& noise) {
    Vector<5> x;
    x << reference::to_vector(c.pose.mean), to_vector(c.seen);
    const double angle = c.pose.mean.heading + c.seen.bearing;
    const double ux = std::cos(angle), uy = std::sin(angle);
    Square<5> T, P = Square<5>::Zero();
    T << 0, 0, 1, 0, 1, -uy, ux, 0, 0, 0, ux, uy, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1;
    P.topLeftCorner<3, 3>() = symmetric(c.pose.covariance);
    P(3, 3) = noise.range, P(4, 4) = noise.bearing;
    const Square<5> S = T.partialPivLu().solve(reference::psd_chol<5>(T * P * T.transpose()));
    const auto image =
        reference::central_differences<2, 1>(x, S, interval, SeenFromAnchor{c.pose.mean});
    mean = image.mean;
    covariance = image.A * image.A.transpose() + image.B * image.B.transpose();
    cross = (S * image.A.transpose()).template topRows<3>();
  }
};

template <class Transform>
void expect_born_alike(const Transform& transform, double interval, double scale,
                       double tolerance) {
  RngStream draw({.seed = 304, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const RandomSight c(draw, scale);
    const BornByAllPoints points(c, interval, c.noise);
    const auto born = new_correlated_anchored_landmark(c.pose, c.seen, c.noise, transform);
    const Vector<2> apart = reference::difference<1, 2>(to_vector(born.landmark.mean), points.mean);
    const auto& [r, b] = born.pose_cross;
    Eigen::Matrix<double, 3, 2> cross;
    cross << r.x, b.x, r.y, b.y, r.h, b.h;
    // In the units of a pose and a sensor that err by half a metre and three degrees, scaled.
    const Eigen::DiagonalMatrix<double, 2> of_sight(2.0 / scale, 20.0 / scale);
    const Eigen::DiagonalMatrix<double, 3> of_pose(2.0 / scale, 2.0 / scale, 20.0 / scale);
    const Eigen::Matrix2d off = symmetric(own_covariance(born.landmark)) - points.covariance;
    EXPECT_LT((of_sight * apart).norm(), tolerance) << "case " << n;
    EXPECT_LT((of_sight * off * of_sight).norm(), tolerance) << "case " << n;
    EXPECT_LT((of_pose * (cross - points.cross) * of_sight).norm(), tolerance) << "case " << n;
    EXPECT_EQ(born.landmark.anchor.x, c.pose.mean.x);
    EXPECT_EQ(born.landmark.anchor.y, c.pose.mean.y);
    EXPECT_EQ(born.landmark.anchor.heading, c.pose.mean.heading);
  }
}

TEST(CorrelatedAnchored, IsBornByCentralDifferencesAsAllPointsAre) {
  expect_born_alike(central(), kInterval, 1.0, 1e-10);
}
TEST(CorrelatedAnchored, IsBornLinearisedAsPointsAreThatLieClose) {
  expect_born_alike(Linearised(), 1.0, 1e-4, 1e-3);
}

TEST(CorrelatedAnchored, ACertainPoseBearsTheDetectionAsItStands) {
  RngStream draw({.seed = 305, .purpose = Draw::test});
  for (int n = 0; n < 50; ++n) {
    RandomSight c(draw);
    c.pose.covariance = {};
    const auto drawn = new_anchored_landmark(c.pose.mean, c.seen, c.noise);
    for (const auto& born :
         {new_correlated_anchored_landmark(c.pose, c.seen, c.noise, Linearised()).landmark,
          new_correlated_anchored_landmark(c.pose, c.seen, c.noise, central()).landmark}) {
      EXPECT_LT((to_vector(born.mean) - to_vector(drawn.mean)).norm(), 1e-12);
      EXPECT_LT((symmetric(own_covariance(born)) - symmetric(own_covariance(drawn))).norm(), 1e-12);
    }
  }
}

TEST(CorrelatedAnchored, ANewOneStandsInTheMapWhereAGaussianThereIsBorn) {
  // With all that it is correlated with: Gz J = Gx.
  RngStream draw({.seed = 306, .purpose = Draw::test});
  for (int n = 0; n < 100; ++n) {
    TwoOfAKind c(draw);
    const auto& [seen, noise] = std::pair(c.sight.seen, c.sight.noise);
    const auto pose = c.anchored.pose(0);
    const auto everywhere = [](const auto& from, auto& to) { to = from; };
    const auto q = new_correlated_anchored_landmark(pose, seen, noise, Linearised());
    place(c.anchored, 0, 1, q, everywhere);
    place(c.in_place, 0, 1, new_correlated_landmark(pose, seen, noise, Linearised()), everywhere);
    c.G.bottomRightCorner<2, 2>() =
        sight_jacobian(linearised_place(q.landmark.anchor, q.landmark.mean));
    const Square<7> P = c.G * covariance_of(c.anchored) * c.G.transpose();
    EXPECT_LT((P - covariance_of(c.in_place)).norm(), 1e-9) << "case " << n;
    EXPECT_LT((to_vector(as_gaussian(c.anchored.landmark(1, 0)).mean) -
               to_vector(c.in_place.landmark(1, 0).mean))
                  .norm(),
              1e-9);
  }
}

}  // namespace
}  // namespace montecarta
