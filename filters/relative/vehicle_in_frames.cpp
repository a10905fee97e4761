// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/vehicle_in_frames.hpp"

namespace montecarta::filters {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

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
      for (const Eigen::Index i : {0, 1}) {  // without the zeros of A and B
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

}  // namespace montecarta::filters
