// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/vehicle_in_frames.hpp"

namespace montecarta::filters {

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
  Eigen::Matrix<double, Eigen::Dynamic, 3> of_pose(P.rows(), 3), before(P.rows(), 3);
  std::size_t k = chain.displacements.size();
  for (const LinearisedPairs::Part& part : pairs.parts) {
    while (k > part.frame) {
      const LinearisedComposition& step = steps_[--k];
      before.noalias() =
          P.middleCols<3>(chain.displacements[k]).lazyProduct(step.by_first.transpose());
      if (k < chain.newest_frame())
        before.noalias() += of_pose.lazyProduct(step.by_second.transpose());
      of_pose.swap(before);
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

}  // namespace montecarta::filters
