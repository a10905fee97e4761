// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_conditioning.hpp"

#include "filters/joint/products.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace montecarta::filters {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// The iteration ends if a step changes the predictions by less than this, in standard deviations
/// of the measurement or, if that is exact, of the remaining variance.
constexpr double kSettled = 1e-2;
constexpr double kSettledExactly = 1.0;
constexpr int kMostHalvings = 8;
/// An increase of the sum by less than this share is due to rounding.
constexpr double kRounding = 1e-12;
/// The share of a variance that remains after an exact measurement.
constexpr double kExact = 1e-6;

using Lower = Eigen::LLT<Eigen::MatrixXd>;

/// The iteration (22.3). Its current point is given by the step from the mean, P y, and by y' P y,
/// the squared length of that step in standard deviations; y itself is not needed.
class Iteration {
 public:
  Iteration(const RelativeChain& chain, const RelativeMeasurement& measurement,
            const Eigen::VectorXd& mean, const Eigen::MatrixXd& P, ConditioningScratch& scratch)
      : chain_(chain),
        measurement_(measurement),
        mean_(mean),
        P_(P),
        vehicle_(scratch.vehicle),
        tried_vehicle_(scratch.tried_vehicle),
        pairs_(scratch.pairs),
        tried_pairs_(scratch.tried_pairs) {}

  /// Returns false if a matrix is not positive definite or a derivative does not exist.
  bool run(int iterations, RelativeOutcome& outcome) {
    step_ = Eigen::VectorXd::Zero(mean_.size());
    if (!linearise(step_, vehicle_, pairs_)) return false;
    for (int i = 0;; ++i) {
      if (!weigh(i == 0)) return false;
      const Eigen::VectorXd before = vehicle_.rows(chain_, pairs_, step_);
      const Eigen::VectorXd innovation = pairs_.residual + before;
      const Eigen::VectorXd weights = S_.solve(innovation);
      report(innovation, i == 0, outcome);
      const Eigen::VectorXd change = projected_ * weights - before;
      if (i >= iterations ||
          R_.matrixL().solve(change).norm() < (is_exact() ? kSettledExactly : kSettled)) {
        step_ = PH_ * weights;
        return true;
      }
      const double crossed = weights.dot(before), full = weights.dot(projected_ * weights);
      if (!take_step(PH_ * weights, crossed, full)) return false;
    }
  }

  const Eigen::VectorXd& step() const { return step_; }
  /// Returns P H' L^-T, with S = L L'.
  Eigen::MatrixXd gain() const {
    const Eigen::MatrixXd L = S_.matrixL();
    Eigen::MatrixXd W = PH_;
    for (Eigen::Index k = 0; k < W.cols(); ++k) {
      for (Eigen::Index j = 0; j < k; ++j) W.col(k) -= L(k, j) * W.col(j);
      W.col(k) /= L(k, k);
    }
    return W;
  }

 private:
  bool is_exact() const { return measurement_.variances.size() == 0; }

  bool linearise(const Eigen::VectorXd& step, VehicleInFrames& vehicle,
                 LinearisedPairs& pairs) const {
    const Eigen::VectorXd at = mean_ + step;
    vehicle.linearise(chain_, at, measurement_.oldest_frame);
    return measurement_.linearise(at, vehicle, pairs);
  }

  bool weigh(bool is_first) {
    vehicle_.columns(chain_, P_, pairs_, PH_);
    projected_ = vehicle_.rows(chain_, pairs_, PH_);
    if (is_first) {
      noise_ = kExact * projected_;
      if (!is_exact()) noise_ = measurement_.variances.asDiagonal();
      R_.compute(noise_);
    }
    S_.compute(projected_ + noise_);
    return R_.info() == Eigen::Success && S_.info() == Eigen::Success;
  }

  void report(const Eigen::VectorXd& innovation, bool is_first, RelativeOutcome& outcome) const {
    const double distance = S_.matrixL().solve(innovation).squaredNorm();
    if (is_first) {
      outcome.nis = distance;
      outcome.dof = static_cast<std::uint32_t>(innovation.size());
    }
    const double log_root = S_.matrixLLT().diagonal().array().log().sum();
    outcome.log_likelihood =
        -0.5 * (distance + static_cast<double>(innovation.size()) * std::log(kTwoPi)) - log_root;
  }

  double squares(const LinearisedPairs& pairs, double prior) const {
    return R_.matrixL().solve(pairs.residual).squaredNorm() + prior;
  }

  /// Steps towards `full_step` of square `full`; `crossed` is its product with the step so far.
  bool take_step(const Eigen::VectorXd& full_step, double crossed, double full) {
    const double now = squares(pairs_, prior_);
    double share = 1.0;
    for (int halvings = 0; halvings <= kMostHalvings; ++halvings, share *= 0.5) {
      const double rest = 1.0 - share;
      const Eigen::VectorXd tried = rest * step_ + share * full_step;
      const double prior =
          rest * rest * prior_ + 2.0 * share * rest * crossed + share * share * full;
      if (!linearise(tried, tried_vehicle_, tried_pairs_)) continue;
      if (squares(tried_pairs_, prior) > now * (1.0 + kRounding) && halvings < kMostHalvings)
        continue;
      step_ = tried;
      prior_ = prior;
      std::swap(vehicle_, tried_vehicle_);
      std::swap(pairs_, tried_pairs_);
      return true;
    }
    return false;
  }

  const RelativeChain& chain_;
  const RelativeMeasurement& measurement_;
  const Eigen::VectorXd& mean_;
  const Eigen::MatrixXd& P_;
  VehicleInFrames &vehicle_, &tried_vehicle_;
  LinearisedPairs &pairs_, &tried_pairs_;
  Eigen::VectorXd step_;
  double prior_ = 0.0;
  Eigen::MatrixXd PH_;         ///< P H'
  Eigen::MatrixXd projected_;  ///< H P H'
  Eigen::MatrixXd noise_;
  Lower R_, S_;
};

}  // namespace

void VehicleInFrames::linearise(const RelativeChain& chain, const Eigen::VectorXd& mean,
                                std::size_t oldest) {
  steps_.resize(chain.displacements.size());
  Pose vehicle{};
  for (std::size_t k = steps_.size(); k-- > oldest;) {
    steps_[k] = linearised_composition(displacement(chain, k, mean), vehicle);
    vehicle = steps_[k].pose;
  }
}

void VehicleInFrames::columns(const RelativeChain& chain, const Eigen::MatrixXd& P,
                              const LinearisedPairs& pairs, Eigen::MatrixXd& PH) const {
  PH.setZero(P.rows(), pairs.residual.size());
  Columns of_pose = Columns::Zero(P.rows(), 3), newer;
  std::size_t k = chain.displacements.size();
  for (const LinearisedPairs::Part& part : pairs.parts) {
    while (k > part.frame) {
      const Eigen::Matrix3d &A = steps_[--k].by_first, &B = steps_[k].by_second;
      const auto by_displacement = P.middleCols<3>(chain.displacements[k]);
      newer.swap(of_pose);
      of_pose.resize(P.rows(), 3);
      for (const Eigen::Index i : {0, 1}) {  // skips the zeros of A and B
        of_pose.col(i) = by_displacement.col(i) + A(i, 2) * by_displacement.col(2) +
                         B(i, 0) * newer.col(0) + B(i, 1) * newer.col(1);
      }
      of_pose.col(2) = by_displacement.col(2) + newer.col(2);
    }
    auto columns = PH.middleCols<2>(2 * part.pair);
    columns.noalias() += of_pose.lazyProduct(part.by_pose.transpose());
    columns.noalias() += P.middleCols<2>(part.row).lazyProduct(part.by_point.transpose());
  }
}

Eigen::MatrixXd VehicleInFrames::rows(const RelativeChain& chain, const LinearisedPairs& pairs,
                                      const Eigen::Ref<const Eigen::MatrixXd>& M) const {
  Eigen::MatrixXd HM = Eigen::MatrixXd::Zero(pairs.residual.size(), M.cols());
  Eigen::Matrix<double, 3, Eigen::Dynamic> of_pose =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, M.cols());
  std::size_t k = chain.displacements.size();
  for (const LinearisedPairs::Part& part : pairs.parts) {
    while (k > part.frame) {
      const LinearisedComposition& step = steps_[--k];
      of_pose = (step.by_second.lazyProduct(of_pose) +
                 step.by_first.lazyProduct(M.middleRows<3>(chain.displacements[k])))
                    .eval();
    }
    HM.middleRows<2>(2 * part.pair) +=
        part.by_pose.lazyProduct(of_pose) + part.by_point.lazyProduct(M.middleRows<2>(part.row));
  }
  return HM;
}

void VehicleGaussian::become_that_in_frame(std::size_t k, const RelativeChain& chain,
                                           const Eigen::VectorXd& mean, const Eigen::MatrixXd& P) {
  const auto [now, A, B] = linearised_composition(displacement(chain, k, mean), pose);
  const Eigen::Index row = chain.displacements[k];
  const Eigen::Matrix3d mixed = A * with_all.middleRows<3>(row) * B.transpose();
  const Eigen::Matrix3d own = A * P.block<3, 3>(row, row) * A.transpose();
  covariance = (B * covariance * B.transpose() + mixed + mixed.transpose() + own).eval();
  with_all = (with_all.lazyProduct(B.transpose()) + P.middleCols<3>(row).lazyProduct(A.transpose()))
                 .eval();
  pose = now;
}

RelativeOutcome condition(const RelativeChain& chain, const RelativeMeasurement& measurement,
                          int iterations, ConditioningScratch& scratch, Eigen::VectorXd& mean,
                          Eigen::MatrixXd& P) {
  Iteration iteration(chain, measurement, mean, P, scratch);
  RelativeOutcome outcome;
  if (!iteration.run(iterations, outcome)) return {.is_faulty = true};
  const Eigen::MatrixXd W = iteration.gain();
  mean += iteration.step();
  for (const Eigen::Index row : chain.displacements) mean(row + 2) = wrap(mean(row + 2));
  add_product(W, -W, Part::whole, P);
  return outcome;
}

}  // namespace montecarta::filters
