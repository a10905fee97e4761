// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/worlds/world_file.hpp"

#include <matio.h>

#include <cstdarg>
#include <memory>
#include <span>

namespace montecarta {
namespace {

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

bool is_matrix_of_doubles(const matvar_t& variable) {
  return variable.rank == 2 && variable.class_type == MAT_C_DOUBLE && !variable.isComplex &&
         variable.data != nullptr;
}

Variable read_variable(mat_t& file, const char* name, const std::string& place) {
  Variable variable(Mat_VarRead(&file, name));
  if (!variable) {
    throw StudyError(place + ": no variable '" + name +
                     "' (a world has lm and wp): save both, 2 x N [m]");
  }
  const bool two_rows_or_columns =
      is_matrix_of_doubles(*variable) && (variable->dims[0] == 2 || variable->dims[1] == 2);
  if (!two_rows_or_columns) {
    throw StudyError(
        place + ": '" + name +
        "' has the wrong shape (2 x N or N x 2 real doubles are needed): save x and y [m]");
  }
  return variable;
}

/// Rows (2 x N) are preferred where both sides are 2, as the published maps are stored.
std::vector<Eigen::Vector2d> points_of(const matvar_t& variable) {
  using Map = Eigen::Map<const Eigen::MatrixXd>;
  const Map matrix(static_cast<const double*>(variable.data),
                   static_cast<Eigen::Index>(variable.dims[0]),
                   static_cast<Eigen::Index>(variable.dims[1]));
  std::vector<Eigen::Vector2d> points;
  if (matrix.rows() == 2) {
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) points.emplace_back(matrix.col(i));
  } else {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) points.emplace_back(matrix.row(i).transpose());
  }
  return points;
}

/// matio writes to standard error by default; our own message says the same with file and remedy.
void say_nothing(int, char*) {}

}  // namespace

World read_world_mat(const std::filesystem::path& path) {
  const std::string place = path.string();
  Mat_LogInitFunc("montecarta", say_nothing);
  const std::unique_ptr<mat_t, CloseMat> file(Mat_Open(place.c_str(), MAT_ACC_RDONLY));
  if (!file)
    throw StudyError(place + ": cannot be read (missing, or no MATLAB file): check the path");
  World world{.name = path.stem().string(),
              .waypoints = points_of(*read_variable(*file, "wp", place)),
              .landmarks = points_of(*read_variable(*file, "lm", place))};
  check_world(world, place);
  return world;
}

}  // namespace montecarta
