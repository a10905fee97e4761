// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/tum_rows.hpp"

#include "engine/errors.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoseNumbers = 8, kOpenVinsNumbers = 20;
constexpr std::size_t kWholeCovariance = 37, kTriangle = 22;  // the timestamp included
constexpr double kSameTime = 1e-6;                            // [s] of pose and covariance

/// Lines of numbers, without comments and empty lines.
class NumberLines {
 public:
  explicit NumberLines(const fs::path& path)
      : path_(path.string()), text_(text_file(path)), rest_(text_) {}

  /// The next line; false after the last one.
  bool next() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      const bool is_open = end == std::string_view::npos;
      const std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(is_open ? rest_.size() : end + 1);
      ++line_;
      const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
      if (words.empty()) continue;
      if (is_open) {
        throw StudyError(place() +
                         ": the last row has no end (the file may have been cut short): end it "
                         "with a line break if it is whole");
      }
      take(words);
      return true;
    }
    return false;
  }
  std::span<const double> numbers() const { return numbers_; }
  std::string place() const { return path_ + ":" + std::to_string(line_); }

 private:
  void take(const std::vector<std::string>& words) {
    numbers_.clear();
    for (const std::string& word : words) {
      const std::optional<double> number = to_number(word);
      if (!number) {
        throw StudyError(place() + ": '" + excerpt(word) +
                         "' is no number (a finite one is needed): write e.g. 12.5");
      }
      numbers_.push_back(*number);
    }
  }

  std::string path_;
  std::string text_;
  std::string_view rest_;
  std::size_t line_ = 0;
  std::vector<double> numbers_;
};

void take_pose(const NumberLines& lines, StateRows& rows) {
  const std::span<const double> n = lines.numbers();
  take_time(n[0], lines.place(), rows.time);
  Eigen::VectorXd state = Eigen::Map<const Eigen::VectorXd>(n.data() + 1, 7);
  normalise_quaternion(state, lines.place());
  rows.state.push_back(std::move(state));
}

/// Of its upper triangle, row by row.
Eigen::MatrixXd from_triangle(std::span<const double> numbers, Eigen::Index side) {
  Eigen::MatrixXd P(side, side);
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < side; ++i) {
    for (Eigen::Index j = i; j < side; ++j) P(i, j) = P(j, i) = numbers[k++];
  }
  return P;
}

/// The rotation's turned from the body into the map.
Eigen::MatrixXd open_vins_covariance(std::span<const double> n, const Eigen::VectorXd& state) {
  const Eigen::Matrix3d R = Eigen::Quaterniond(Eigen::Vector4d(state.tail<4>())).toRotationMatrix();
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(6, 6);
  P.topLeftCorner<3, 3>() = from_triangle(n.subspan(kPoseNumbers + 6, 6), 3);
  const Eigen::Matrix3d turned = R * from_triangle(n.subspan(kPoseNumbers, 6), 3) * R.transpose();
  P.bottomRightCorner<3, 3>() = 0.5 * (turned + turned.transpose());
  return P;
}

void refuse_width(const NumberLines& lines, const std::string& wanted) {
  throw StudyError(lines.place() + ": " + std::to_string(lines.numbers().size()) +
                   " numbers in the line (" + wanted + "): write all lines alike");
}

std::vector<Eigen::MatrixXd> covariances_in(const fs::path& path, const std::vector<double>& times,
                                            const fs::path& of) {
  NumberLines lines(path);
  std::vector<Eigen::MatrixXd> all;
  while (lines.next()) {
    const std::span<const double> n = lines.numbers();
    if (n.size() != kWholeCovariance && n.size() != kTriangle) {
      refuse_width(lines, "a timestamp and 36 or 21 are a covariance");
    }
    if (all.size() == times.size() || std::abs(n[0] - times[all.size()]) > kSameTime) {
      throw StudyError(lines.place() + ": time " + to_text(n[0]) + " s is not that of row " +
                       std::to_string(all.size() + 1) + " of " + of.string() +
                       " (every pose has one covariance): write them at the same times");
    }
    if (n.size() == kTriangle) {
      all.push_back(from_triangle(n.subspan(1), 6));
    } else {
      all.emplace_back(
          Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(n.data() + 1));
    }
  }
  if (all.size() == times.size()) return all;
  throw StudyError(path.string() + ": " + std::to_string(all.size()) + " covariances of " +
                   std::to_string(times.size()) + " poses in " + of.string() +
                   " (every pose has one): write them at the same times");
}

}  // namespace

bool is_tum(const fs::path& path) {
  const std::string text = text_file(path);
  std::string_view rest = text;
  bool names_timestamp = false;
  while (!rest.empty()) {
    const std::size_t length = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, length));
    rest.remove_prefix(std::min(length + 1, rest.size()));
    names_timestamp = names_timestamp || line.starts_with("# timestamp");
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
    return line.find(',') == std::string_view::npos && words.size() > 1 && to_number(words.front());
  }
  return names_timestamp;  // a run that gave no estimates
}

std::optional<fs::path> covariance_beside(const fs::path& path) {
  fs::path beside = path;
  beside.replace_extension(".cov");
  std::error_code ignored;
  if (beside == path || !fs::is_regular_file(beside, ignored)) return std::nullopt;
  return beside;
}

StateRows read_tum_estimates(const fs::path& path) {
  NumberLines lines(path);
  StateRows rows{pose_in_space_shape(), {}, {}, {}, {}, {}};
  const std::optional<fs::path> beside = covariance_beside(path);
  while (lines.next()) {
    const std::size_t width = lines.numbers().size();
    if (width == kPoseNumbers && !beside) {
      throw StudyError(lines.place() +
                       ": a pose without a covariance (a verdict needs one): write the 12 numbers "
                       "of OpenVINS behind it, or a file of covariances beside, " +
                       fs::path(path).replace_extension(".cov").filename().string());
    }
    if (width != (beside ? kPoseNumbers : kOpenVinsNumbers)) {
      refuse_width(lines, beside ? "a timestamp and 7 are a pose, whose covariance is in " +
                                       beside->filename().string()
                                 : "a timestamp, 7 of the pose and 12 of the covariance are");
    }
    take_pose(lines, rows);
    if (!beside)
      rows.covariance.push_back(open_vins_covariance(lines.numbers(), rows.state.back()));
  }
  if (beside) {
    rows.covariance = covariances_in(*beside, rows.time, path);
  } else {
    rows.has_cross_terms = rows.time.empty();
  }
  return rows;
}

StateRows read_tum_truth(const fs::path& path, const StateShape& shape) {
  if (shape != pose_in_space_shape()) {
    throw StudyError(path.string() +
                     ": a trajectory of poses in space (the estimates are of another state): give "
                     "a truth as CSV with the columns " +
                     joined(shape.columns, ","));
  }
  NumberLines lines(path);
  StateRows rows{pose_in_space_shape(), {}, {}, {}, {}, {}};
  while (lines.next()) {
    if (lines.numbers().size() < kPoseNumbers) refuse_width(lines, "a timestamp and 7 are a pose");
    take_pose(lines, rows);
  }
  if (!rows.time.empty()) return rows;
  throw StudyError(path.string() + ": no rows (a truth of no time): write one row for each time");
}

}  // namespace montecarta::experiments
