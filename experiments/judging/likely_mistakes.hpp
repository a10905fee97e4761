// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/state_rows.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Contents of files that are judged as they are, but are likely a mistake: variances that mark a
/// component as unknown, quaternions with w first, estimates that are a copy of the truth, rows of
/// one time, units.
class LikelyMistakes {
 public:
  /// The errors of the estimates are those of `convention`. `compares_starts` says whether a run
  /// that begins far from its truth is a mistake, `is_pair` whether truths are the estimates of a
  /// second estimator.
  LikelyMistakes(std::span<const std::string> cells, ErrorConvention convention,
                 bool compares_starts, bool is_pair);

  /// Adds the truth of a run. Throws StudyError if angles are in another unit than their columns
  /// say.
  void add_truth(const StateRows& truth, const std::filesystem::path& path);
  /// Adds one file of the estimator `cell`, with the truth of its run, which was added before.
  /// Throws StudyError if times or angles are in another unit than their columns say.
  void add(std::size_t cell, const StateRows& rows, const std::filesystem::path& path,
           const StateRows& truth);
  /// Sentences on what was found, with component, file and line.
  std::vector<std::string> notes() const;

 private:
  /// Signs that the variance of a component was not estimated, in the order of their notes.
  enum Sign : std::uint8_t { negative, zero, huge, tiny };
  static constexpr std::size_t kSigns = 4;
  /// The rows in which a component has a sign.
  struct Marked {
    std::uint64_t rows = 0;
    double value = 0.0;   ///< variance in the first of them
    bool varies = false;  ///< whether the variance is another one in a later row
    std::string first;    ///< file and line of the first of them
  };
  /// Sums of the differences between estimates and truth.
  struct Misfit {
    double angle = 0.0;  ///< [rad] between the rotations
    double nees = 0.0;   ///< divided by the number of components; of usable samples
  };
  struct OfCell {
    std::string label;
    StateShape shape;
    std::vector<std::array<Marked, kSigns>> marked;  ///< {component}
    std::uint64_t rows = 0;
    /// Sums over rows: as stated, and if the quaternions of the estimates, or of the truth, have w
    /// first.
    Misfit as_stated;
    std::array<Misfit, 2> w_first;
    std::uint64_t copies = 0;        ///< number of rows that equal the truth
    std::uint64_t later_copies = 0;  ///< those that are not the first row of a file
    std::string first_copy;          ///< file and line of the first of them
    bool has_copied_run = false;     ///< whether most rows of a run are such
    std::uint64_t blanks = 0;        ///< those of the later ones with a covariance of 0
    std::string first_blank;         ///< file and line of the first of them
    std::uint64_t runs = 0;
    std::uint64_t apart = 0;  ///< runs that begin far from their truth for what they claim
    double distance = 0.0;    ///< [m] of the first of them
    std::string first_apart;  ///< file and line of the first of them
  };

  static void mark(const StateRows& rows, std::size_t row, const std::filesystem::path& path,
                   OfCell& cell);
  Misfit misfit(const StateRows& rows, std::size_t row, const Eigen::VectorXd& mean,
                const Eigen::VectorXd& truth) const;
  void compare_quaternions(const StateRows& rows, std::size_t row, const StateRows& truth,
                           OfCell& cell) const;
  static void compare_starts(const StateRows& rows, const std::filesystem::path& path,
                             const StateRows& truth, OfCell& cell);
  static void add_copies(const OfCell& cell, const std::string& other,
                         std::vector<std::string>& notes);
  static void add_marks(const OfCell& cell, std::vector<std::string>& notes);
  void add_notes(const OfCell& cell, std::vector<std::string>& notes) const;

  ErrorConvention convention_;
  bool compares_starts_, is_pair_;
  std::vector<OfCell> cells_;
  std::filesystem::path truth_path_;  ///< file of the last truth
  std::uint64_t left_out_ = 0;        ///< number of rows of one time that were not kept
  std::string first_left_out_;        ///< the first file with one
  std::string on_angles_, on_times_;
};

}  // namespace montecarta::experiments
