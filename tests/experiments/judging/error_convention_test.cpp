// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/error_convention.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/verdict/convention_hints.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/text/words.hpp"
#include "tests/analysis/verdict_studies.hpp"
#include "tests/doubles/matchers.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

using analysis::ConventionHint;
using analysis::ConventionHints;

StateShape plane_shape() {
  return {StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};
}

StateShape space_shape() {
  return {StateKind::pose_in_space,
          {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
          {"x", "y", "z", "rx", "ry", "rz"},
          {"m", "m", "m", "rad", "rad", "rad"}};
}

/// A pose in space with a velocity and a bias, of which the angle may be wrapped.
StateShape navigation_shape() {
  StateShape shape = space_shape();
  shape.columns.insert(shape.columns.end(), {"vx_mps", "vy_mps", "vz_mps", "tilt_rad"});
  shape.components.insert(shape.components.end(), {"vx", "vy", "vz", "tilt"});
  shape.units.insert(shape.units.end(), {"mps", "mps", "mps", "rad"});
  return shape;
}

/// exp(turn) and V(turn) by their series.
struct Exponential {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity(), V = Eigen::Matrix3d::Identity();

  explicit Exponential(const Eigen::Vector3d& turn) {
    const Eigen::Matrix3d cross{
        {0.0, -turn.z(), turn.y()}, {turn.z(), 0.0, -turn.x()}, {-turn.y(), turn.x(), 0.0}};
    Eigen::Matrix3d power = Eigen::Matrix3d::Identity();
    for (int k = 1; k < 30; ++k) {
      power = power * cross / k;
      R += power;
      V += power / (k + 1);
    }
  }
};

/// The mean that has the error `error` from `truth` by a convention, computed from the definition
/// of the convention and not with the code under test.
Eigen::VectorXd mean_with_error(const StateShape& shape, ErrorConvention convention,
                                const Eigen::VectorXd& truth, const Eigen::VectorXd& error) {
  const bool plane = shape.kind == StateKind::pose;
  Eigen::Vector3d p, rho, turn;
  Eigen::Matrix3d R;
  if (plane) {
    p << truth(0), truth(1), 0.0;
    rho << error(0), error(1), 0.0;
    turn << 0.0, 0.0, error(2);
    R = Eigen::AngleAxisd(truth(2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  } else {
    p = truth.head<3>();
    rho = error.head<3>();
    turn = error.segment<3>(3);
    R = Eigen::Quaterniond(Eigen::Vector4d(truth.segment<4>(3))).toRotationMatrix();
  }
  const Exponential exponential(turn);
  const bool is_body = convention == ErrorConvention::body;
  const bool is_left = convention == ErrorConvention::left_invariant;
  const bool is_turned_in_body = is_body || is_left || convention == ErrorConvention::world_body;
  const Eigen::Matrix3d turned = is_turned_in_body ? R * exponential.R : exponential.R * R;
  const auto moved = [&](const Eigen::Vector3d& vector, const Eigen::Vector3d& by) {
    if (is_body) return Eigen::Vector3d(vector + turned * by);
    if (is_left) return Eigen::Vector3d(vector + R * exponential.V * by);
    if (convention != ErrorConvention::right_invariant) return Eigen::Vector3d(vector + by);
    return Eigen::Vector3d(exponential.R * vector + exponential.V * by);
  };
  p = moved(p, rho);
  Eigen::VectorXd mean(shape.width());
  if (plane) {
    mean << p.x(), p.y(), wrap(truth(2) + error(2));
  } else {
    mean.head<7>() << p, Eigen::Quaterniond(turned).normalized().coeffs();
  }
  if (shape.width() > 7) {
    mean.segment<3>(7) = moved(truth.segment<3>(7), error.segment<3>(6));
    mean(10) = wrap(truth(10) + error(9));
  }
  return mean;
}

/// A state some ten metres from the origin.
Eigen::VectorXd drawn_truth(const StateShape& shape, RngStream& draw) {
  Eigen::VectorXd truth(shape.width());
  for (auto& value : truth) value = 10.0 * draw.normal();
  if (shape.kind == StateKind::pose) truth(2) = wrap(truth(2));
  if (shape.kind == StateKind::pose_in_space) truth.segment<4>(3).normalize();
  return truth;
}

/// Deviations of 0.3 m and 0.1 rad that differ from component to component, correlated.
Eigen::MatrixXd some_covariance(const StateShape& shape) {
  const auto d = static_cast<Eigen::Index>(shape.dimension());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const double deviation = shape.units[static_cast<std::size_t>(i)] == "rad" ? 0.1 : 0.3;
    L(i, i) = deviation * (i % 2 == 0 ? 1.0 : 0.2);
    for (Eigen::Index j = 0; j < i; ++j) L(i, j) = 0.3 * deviation * (i + j == 2 ? -0.5 : 0.2);
  }
  return L * L.transpose();
}

Eigen::VectorXd drawn_error(const Eigen::MatrixXd& covariance, RngStream& draw) {
  Eigen::VectorXd normal(covariance.rows());
  for (auto& value : normal) value = draw.normal();
  return covariance.llt().matrixL() * normal;
}

// Law: the error of a mean that was moved by an error is that error.
TEST(ErrorConvention, FindsTheErrorThatMovedTheMean) {
  RngStream draw({11, 0, 0, 0, Draw::test});
  for (const StateShape& shape : {plane_shape(), space_shape(), navigation_shape()}) {
    for (const ErrorConvention convention : conventions_of(shape.kind)) {
      for (int k = 0; k < 100; ++k) {
        const Eigen::VectorXd truth = drawn_truth(shape, draw);
        const double size = k % 3 == 0 ? 1e-7 : 1.0;
        const Eigen::VectorXd error = size * drawn_error(some_covariance(shape), draw);
        const Eigen::VectorXd mean = mean_with_error(shape, convention, truth, error);
        const Eigen::VectorXd found = error_of(shape, convention, mean, truth);
        EXPECT_LT((found - error).norm(), 1e-12)
            << name_of(convention) << " " << name_of(shape.kind);
      }
    }
  }
}

// A shift of one along an arc of a quarter turn ends where the error in the body does not.
TEST(ErrorConvention, LeftInvariantFollowsTheArc) {
  const Eigen::Vector3d truth(0, 0, 0), mean(2.0 / kPi, 2.0 / kPi, kPi / 2.0);
  const Eigen::VectorXd found =
      error_of(plane_shape(), ErrorConvention::left_invariant, mean, truth);
  EXPECT_LT((found - Eigen::Vector3d(1.0, 0.0, kPi / 2.0)).norm(), 1e-12);
}

// A turn by half a circle, and either sign of a quaternion.
TEST(ErrorConvention, KnowsTheShorterWayRound) {
  Eigen::VectorXd truth(7), mean(7);
  truth << 1, 2, 3, 0, 0, 0, 1;
  mean << 1, 2, 3, 0, 0, std::sin(1.5), std::cos(1.5);
  const Eigen::VectorXd error = error_of(space_shape(), ErrorConvention::world, mean, truth);
  EXPECT_NEAR(error(5), 3.0, 1e-12);
  mean.tail<4>() *= -1.0;
  EXPECT_LT((error_of(space_shape(), ErrorConvention::world, mean, truth) - error).norm(), 1e-12);
  const Eigen::Vector3d there(0, 0, 3.1), back(0, 0, -3.1);
  EXPECT_NEAR(error_of(plane_shape(), ErrorConvention::world, there, back)(2), 6.2 - 2.0 * kPi,
              1e-12);
}

TEST(ErrorConvention, OfAVectorWrapsAnglesOnly) {
  const StateShape shape{StateKind::vector, {"a_rad", "b_m"}, {"a", "b"}, {"rad", "m"}};
  const Eigen::Vector2d error =
      error_of(shape, ErrorConvention::world, Eigen::Vector2d(3, 9), Eigen::Vector2d(-3, 0));
  EXPECT_NEAR(error(0), 6.0 - 2.0 * kPi, 1e-12);
  EXPECT_EQ(error(1), 9.0);
  EXPECT_EQ(conventions_of(StateKind::vector).size(), 1U);
}

// Law: to first order the covariance in the map is that of mean - truth.
TEST(ErrorConvention, TurnsCovariancesIntoTheMap) {
  RngStream draw({12, 0, 0, 0, Draw::test});
  for (const ErrorConvention convention : conventions_of(StateKind::pose)) {
    const Eigen::Vector3d mean = drawn_truth(plane_shape(), draw);
    Eigen::Matrix3d jacobian;  // of mean - truth by the error, around 0, at this mean
    constexpr double kStep = 1e-6;
    for (int c = 0; c < 3; ++c) {
      const Eigen::VectorXd error = kStep * Eigen::Vector3d::Unit(c);
      const Eigen::VectorXd moved = mean_with_error(plane_shape(), convention, mean, error);
      jacobian.col(c) =
          error_of(plane_shape(), ErrorConvention::world, moved, mean).head<3>() / kStep;
    }
    const Eigen::Matrix3d P = some_covariance(plane_shape());
    const Eigen::Matrix3d expected = jacobian * P * jacobian.transpose();
    EXPECT_LT((covariance_in_map(convention, mean, P) - expected).norm(), 1e-4 * expected.norm())
        << name_of(convention);
  }
}

TEST(ErrorConvention, IsExplained) {
  std::vector<std::string> names;
  for (const ErrorConvention convention : conventions_of(StateKind::pose_in_space)) {
    names.push_back(name_of(convention));
    EXPECT_THAT(commands_text(), HasSubstr("\n  " + names.back() + ": "));
  }
  EXPECT_THAT(commands_text(), HasSubstr("--error " + joined(names, "|") + "  "));
}

constexpr std::uint64_t kRuns = 20, kScans = 10;

/// Errors with a covariance that is right by one convention, judged by all.
ConventionHint hint_of(const StateShape& shape, ErrorConvention right, std::uint64_t study) {
  const Eigen::MatrixXd P = some_covariance(shape);
  ConventionHints hints(shape.dimension(), kScans);
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RngStream draw({study, run, 0, static_cast<std::uint32_t>(right), Draw::test});
    std::array<std::vector<double>, engine::kErrorConventions.size()> nees;
    for (std::size_t s = 0; s < kScans; ++s) {
      const Eigen::VectorXd truth = drawn_truth(shape, draw);
      const Eigen::VectorXd mean = mean_with_error(shape, right, truth, drawn_error(P, draw));
      for (std::size_t k = 0; k < conventions_of(shape.kind).size(); ++k) {
        const ErrorConvention by = conventions_of(shape.kind)[k];
        EXPECT_EQ(name_of(by), engine::kErrorConventions[k].name);
        nees[k].push_back(analysis::imported_nees(error_of(shape, by, mean, truth), P).value);
      }
    }
    hints.add(nees);
  }
  const std::vector<double> times = analysis::scan_times(kScans, 0.2);
  return hints.result(times, 0.95, 1.1);
}

/// Whether two conventions are the same to first order.
bool are_alike(ErrorConvention a, ErrorConvention b) {
  const auto is_on_the_right = [](ErrorConvention one) {
    return one == ErrorConvention::body || one == ErrorConvention::left_invariant;
  };
  return a == b || (is_on_the_right(a) && is_on_the_right(b));
}

/// Whether a convention passes that is not like `right`.
bool passes_another(const ConventionHint& hint, const StateShape& shape, ErrorConvention right) {
  return std::ranges::any_of(conventions_of(shape.kind), [&](ErrorConvention by) {
    const analysis::Verdict& found = hint.by_convention[static_cast<std::size_t>(by)];
    return !are_alike(by, right) &&
           std::ranges::none_of(found.families, &analysis::FamilyTest::is_rejected);
  });
}

/// Numbers of studies in which the right convention fits, and a wrong one.
struct Fitting {
  double right = 0.0, wrong = 0.0, named = 0.0;
};

Fitting fitting_in(const StateShape& shape, ErrorConvention right, std::uint64_t studies) {
  Fitting fitting;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const ConventionHint hint = hint_of(shape, right, study);
    fitting.wrong += passes_another(hint, shape, right) ? 1.0 : 0.0;
    const ErrorConvention other =
        right == ErrorConvention::world ? ErrorConvention::body : ErrorConvention::world;
    const std::string by_other = in_words(hint, "mine", name_of(other));
    const std::string fits = by_other.substr(0, by_other.find(", and be rejected as"));
    const bool has_it = fits.find("would pass as") != std::string::npos &&
                        fits.find(" " + name_of(right) + " (NEES ratio") != std::string::npos;
    fitting.right += has_it ? 1.0 : 0.0;
    fitting.named +=
        has_it && by_other.find("are they of another error") != std::string::npos ? 1.0 : 0.0;
  }
  return fitting;
}

// Law: the convention by which errors were drawn passes in 95 % of studies, wrong ones do not, and
// who said a wrong one hears of the right one. `MONTECARTA_STUDIES=1000` draws more studies.
TEST(ConventionHintsSlow, NameTheRightConvention) {
  const std::uint64_t studies = analysis::studies_of_a_line(60);
  const auto n = static_cast<double>(studies);
  for (const StateShape& shape : {plane_shape(), space_shape()}) {
    for (const ErrorConvention right : conventions_of(shape.kind)) {
      const Fitting found = fitting_in(shape, right, studies);
      const std::string of = name_of(shape.kind) + ", " + name_of(right);
      EXPECT_GT(found.right / n, 0.95 - 5.0 * std::sqrt(0.05 * 0.95 / n)) << of;
      EXPECT_LE(found.wrong / n, 0.02) << of;
      EXPECT_GE(found.named, found.right - 0.02 * n) << of;
      std::cout << of << ": passes in " << found.right << " of " << n << " studies, named in "
                << found.named << ", another passes in " << found.wrong << "\n";
    }
  }
}

/// {scan} Errors with the covariance P, which is written after a mistake in its layout.
analysis::ErrorRows misread_errors(const Eigen::MatrixXd& P, const Eigen::MatrixXd& as_written,
                                   std::uint64_t run) {
  RngStream draw({13, run, 0, 0, Draw::test});
  analysis::ErrorRows errors;
  for (std::size_t s = 0; s < kScans; ++s) {
    const Eigen::VectorXd error = drawn_error(P, draw);
    errors.value.insert(errors.value.end(), error.begin(), error.end());
    errors.covariance.insert(errors.covariance.end(), as_written.data(),
                             as_written.data() + as_written.size());
  }
  return errors;
}

/// The hint on such errors of a vector, which has one convention.
std::string hint_on_layout(const std::vector<std::string>& units, const Eigen::MatrixXd& P,
                           const Eigen::MatrixXd& as_written) {
  ConventionHints hints(units.size(), kScans);
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const analysis::ErrorRows errors = misread_errors(P, as_written, run);
    analysis::NeesBy<engine::kErrorConventions.size()> by_convention;
    for (std::size_t s = 0; s < kScans; ++s) {
      by_convention[0].push_back(
          analysis::imported_nees(errors.error(s), errors.covariance_of(s)).value);
    }
    hints.add(by_convention, analysis::nees_by_mistake(errors, units));
    hints.add_variances(errors, units);
  }
  const std::vector<double> times = analysis::scan_times(kScans, 0.2);
  return in_words(hints.result(times, 0.95, 1.1), "mine", "world");
}

TEST(ConventionHints, NameMistakesInTheLayout) {
  for (const StateShape& shape : {plane_shape(), space_shape()}) {
    const Eigen::MatrixXd P = some_covariance(shape);
    const auto d = P.rows(), angles = d / 2;
    Eigen::VectorXd degrees = Eigen::VectorXd::Ones(d);
    degrees.tail(angles).setConstant(180.0 / kPi);
    const Eigen::MatrixXd in_degrees = degrees.asDiagonal() * P * degrees.asDiagonal();
    EXPECT_THAT(hint_on_layout(shape.units, P, in_degrees),
                HasSubstr("with angles in degrees (NEES"));
    const Eigen::MatrixXd in_rad =
        degrees.cwiseInverse().asDiagonal() * P * degrees.cwiseInverse().asDiagonal();
    EXPECT_THAT(hint_on_layout(shape.units, P, in_rad), HasSubstr("with angles in rad where"));
    Eigen::MatrixXd rotation_first(d, d);
    for (Eigen::Index i = 0; i < d; ++i) {
      for (Eigen::Index j = 0; j < d; ++j) {
        rotation_first((i + angles) % d, (j + angles) % d) = P(i, j);
      }
    }
    EXPECT_THAT(hint_on_layout(shape.units, P, rotation_first),
                HasSubstr("with rotation before position (NEES"));
    EXPECT_EQ(hint_on_layout(shape.units, P, P), "");
    EXPECT_EQ(hint_on_layout(shape.units, P, 1e4 * P), "") << "merely conservative";
  }
}

// A mistake that explains most of a wrong size is named although the rest is rejected too.
TEST(ConventionHints, NameMistakesThatBringTheErrorsFarNearer) {
  const StateShape shape = space_shape();
  Eigen::VectorXd deviations(6);
  deviations << 0.5, 0.4, 0.6, 0.01, 0.02, 0.01;
  const Eigen::MatrixXd P = deviations.cwiseAbs2().asDiagonal();
  Eigen::VectorXd claimed = deviations;
  claimed.head<3>() /= 1.6;  // optimistic, whatever the layout is
  const auto hint_for = [&](const Eigen::VectorXd& variances) {
    return hint_on_layout(shape.units, P, variances.asDiagonal());
  };
  const Eigen::VectorXd right = claimed.cwiseAbs2();
  Eigen::VectorXd rotation_first(6), degrees = right, millimetres = right;
  rotation_first << right.tail<3>(), right.head<3>();
  degrees.tail<3>() *= std::pow(180.0 / kPi, 2);
  millimetres.head<3>() *= 1e6;
  const std::string far = "is far nearer to 1, whatever the verdict would be";
  EXPECT_THAT(hint_for(rotation_first),
              AllOf(HasSubstr("written with rotation before position,"), HasSubstr(far)));
  EXPECT_THAT(hint_for(degrees), HasSubstr("written with angles in degrees,"));
  EXPECT_THAT(hint_for(millimetres), HasSubstr("written with lengths in mm,"));
  EXPECT_THAT(hint_for(claimed), HasSubstr("with standard deviations in place of variances,"));
  EXPECT_EQ(hint_for(right), "");
  EXPECT_EQ(hint_for(100.0 * right), "");
  Eigen::VectorXd errors = P.diagonal(), variances = errors;  // rotations are wrong, of other cause
  errors.tail<3>().setConstant(36.0);
  variances.tail<3>().setConstant(1e-3);
  EXPECT_EQ(hint_on_layout(shape.units, errors.asDiagonal(), variances.asDiagonal()), "");
}

// A state may have no angles, or no lengths.
TEST(ConventionHints, NameMistakesOfStatesWithOneUnit) {
  const Eigen::MatrixXd P = 0.25 * Eigen::MatrixXd::Identity(2, 2);
  const std::vector<std::string> lengths = {"m", "m"}, angles = {"rad", "rad"};
  EXPECT_THAT(hint_on_layout(lengths, P, P * 1e6 / 2.56),
              AllOf(HasSubstr("with lengths in mm, squared errors of lengths are 2."),
                    Not(HasSubstr("angles"))));
  EXPECT_THAT(hint_on_layout(angles, P, P * std::pow(180.0 / kPi, 2) / 2.56),
              AllOf(HasSubstr("with angles in degrees, squared errors of angles are 2."),
                    Not(HasSubstr("lengths"))));
  EXPECT_EQ(hint_on_layout(std::vector<std::string>{"s", "s"}, P, 1e6 * P), "");
}

// The variance of a heading in degrees hides in the NEES of a pose, of which a few runs show that
// of the positions alone.
TEST(ConventionHints, NameMistakesOfAPartThatIsFarTooSmall) {
  const StateShape shape = plane_shape();
  ConventionHint hint = hint_of(shape, ErrorConvention::world, 1);
  EXPECT_THAT(in_words(hint, "mine", "world"), Not(HasSubstr("degrees")));
  const Eigen::MatrixXd P = 0.25 * Eigen::MatrixXd::Identity(3, 3);
  Eigen::MatrixXd as_written = P;
  as_written(2, 2) *= std::pow(180.0 / kPi, 2);
  hint.mistakes.add(misread_errors(P, as_written, 1), shape.units);
  const std::string in_degrees = "with angles in degrees, squared errors of lengths are";
  EXPECT_THAT(in_words(hint, "mine", "world"), HasSubstr(in_degrees));
  EXPECT_THAT(in_words(hint, "mine", "world", true), HasSubstr(in_degrees));
  EXPECT_THAT(in_words(hint, "mine", "world", true), Not(HasSubstr("would pass")));
}

TEST(ConventionHints, NameConventionsThatBringTheErrorsFarNearer) {
  ConventionHint hint = hint_of(plane_shape(), ErrorConvention::body, 1);
  const auto with_ratio = [&](double ratio) {
    analysis::Verdict verdict = hint.by_convention[0];
    for (analysis::FamilyTest& test : verdict.families) {
      if (test.family == analysis::Family::size) test.members.front().estimate = ratio;
    }
    return verdict;
  };
  hint.by_convention = {with_ratio(182.0), with_ratio(1.7), with_ratio(40.0)};
  EXPECT_THAT(in_words(hint, "mine", "world"),
              HasSubstr("far nearer to 1 than the ratio 182 of world is that of body"));
  EXPECT_THAT(in_words(hint, "mine", "body"), Not(HasSubstr("far nearer")));
  hint.by_convention = {with_ratio(0.0), with_ratio(0.0)};
  EXPECT_THAT(in_words(hint, "mine", "world"), Not(HasSubstr("far nearer")));
}

TEST(ConventionHints, SayWhatCannotBeToldApart) {
  const ConventionHint hint = hint_of(plane_shape(), ErrorConvention::body, 1);
  EXPECT_THAT(in_words(hint, "mine", "world"), HasSubstr("would pass as body (NEES ratio "));
  EXPECT_THAT(in_words(hint, "mine", "body"),
              AllOf(HasSubstr("would pass as left-invariant (NEES ratio "),
                    HasSubstr("be rejected as world (NEES ratio ")));
  const ConventionHint none{{hint.by_convention[0], hint.by_convention[0], hint.by_convention[0]}};
  EXPECT_THAT(in_words(none, "mine", "body"), HasSubstr("rejected as well: world (NEES ratio "));
  const ConventionHint alike{{hint.by_convention[1], hint.by_convention[1]}};
  EXPECT_THAT(in_words(alike, "mine", "body"), HasSubstr("cannot tell those that pass apart"));
  EXPECT_EQ(in_words(alike, "mine", "body", true), "") << "more tests than the hint has refute it";
  EXPECT_EQ(in_words(ConventionHint{}, "mine", "world"), "") << "of a vector";
}

}  // namespace
}  // namespace montecarta::experiments
