// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/mat_file.hpp"
#include "experiments/worlds/world_file.hpp"

namespace montecarta::experiments {
namespace {

/// Rows (2 x N) are preferred where both sides are 2, as the published maps are stored.
std::vector<Eigen::Vector2d> points_of(const MatFile& file, const std::string& name) {
  const Eigen::MatrixXd& matrix = file.matrix(name);
  if (matrix.rows() != 2 && matrix.cols() != 2) {
    throw StudyError(file.place() + ": '" + name +
                     "' has the wrong shape (2 x N or N x 2 is needed): save x and y [m]");
  }
  std::vector<Eigen::Vector2d> points;
  if (matrix.rows() == 2) {
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) points.emplace_back(matrix.col(i));
  } else {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) points.emplace_back(matrix.row(i).transpose());
  }
  return points;
}

}  // namespace

World read_world_mat(const std::filesystem::path& path) {
  const MatFile file(path);
  World world{.name = path.stem().string(),
              .waypoints = points_of(file, "wp"),
              .landmarks = points_of(file, "lm")};
  check_world(world, path.string());
  return world;
}

}  // namespace montecarta::experiments
