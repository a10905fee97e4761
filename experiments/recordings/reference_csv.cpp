// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/log_csv_names.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Cholesky>

namespace montecarta::experiments {
namespace {

using log_csv::ReferenceColumns;

constexpr double kLeastDeviation = 1e-9;  // [m, rad]

/// Diagonal, of as many sigmas from field `first` on.
Eigen::Matrix3d covariance_of_sigmas(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < dimension; ++i) {
    const std::size_t field = first + static_cast<std::size_t>(i);
    const double sigma = rows.number(field, "standard deviation");
    if (!(sigma >= kLeastDeviation)) {
      throw StudyError(rows.place() + ": standard deviation " + std::string(rows.field(field)) +
                       " (every fix has an error, at least 1e-9 m or rad): correct it, or leave "
                       "the sigmas out where nobody knows them");
    }
    covariance(i, i) = sigma * sigma;
  }
  return covariance;
}

bool is_positive_definite(const Eigen::Matrix3d& covariance, int dimension) {
  const Eigen::VectorXd variances = covariance.diagonal().head(dimension);
  if (!(variances.array() >= kLeastDeviation * kLeastDeviation).all()) return false;
  const Eigen::VectorXd scale = variances.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * covariance.topLeftCorner(dimension, dimension) * scale.asDiagonal();
  constexpr double kLeastPivot = 1e-9;
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation);
  return factor.info() == Eigen::Success &&
         (factor.matrixLLT().diagonal().array().square() > kLeastPivot).all();
}

/// Of its lower triangle, row by row from field `first` on.
Eigen::Matrix3d covariance_in(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t field = first;
  for (int i = 0; i < dimension; ++i) {
    for (int j = 0; j <= i; ++j) {
      covariance(i, j) = covariance(j, i) = rows.number(field++, "covariance");
    }
  }
  if (is_positive_definite(covariance, dimension)) return covariance;
  throw StudyError(rows.place() +
                   ": the covariance is not positive definite (variances must be above 0 and "
                   "correlations between -1 and 1): correct it, or give standard deviations");
}

}  // namespace

ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name) {
  CsvRows rows(path, log_csv::kReference);
  const auto columns = static_cast<ReferenceColumns>(rows.header());
  const bool headed = log_csv::has_heading(columns);
  const std::size_t behind = headed ? 4 : 3;  // the first field that is neither time nor pose
  ReferencePath reference{.name = name, .time = {}, .position = {}, .heading = {}};
  while (rows.next()) {
    reference.time.push_back(rows.number(0, "time"));
    reference.position.emplace_back(rows.number(1, "coordinate"), rows.number(2, "coordinate"));
    if (headed) reference.heading.push_back(rows.number(3, "heading"));
    if (columns == ReferenceColumns::position || columns == ReferenceColumns::pose) continue;
    const bool by_sigmas =
        columns == ReferenceColumns::position_sigmas || columns == ReferenceColumns::pose_sigmas;
    reference.covariance.push_back(by_sigmas
                                       ? covariance_of_sigmas(rows, behind, reference.dimension())
                                       : covariance_in(rows, behind, reference.dimension()));
  }
  check_reference(reference, path.string());
  return reference;
}

std::string csv_of(const ReferencePath& reference) {
  const bool headed = !reference.heading.empty(), known = !reference.covariance.empty();
  std::string text = log_csv::header_of(known    ? headed ? ReferenceColumns::pose_covariance
                                                          : ReferenceColumns::position_covariance
                                        : headed ? ReferenceColumns::pose
                                                 : ReferenceColumns::position) +
                     "\n";
  for (std::size_t f = 0; f < reference.time.size(); ++f) {
    text += to_text(reference.time[f]) + "," + to_text(reference.position[f].x()) + "," +
            to_text(reference.position[f].y());
    if (headed) text += "," + to_text(reference.heading[f]);
    for (int i = 0; known && i < reference.dimension(); ++i) {
      for (int j = 0; j <= i; ++j) text += "," + to_text(reference.covariance[f](i, j));
    }
    text += "\n";
  }
  return text;
}

}  // namespace montecarta::experiments
