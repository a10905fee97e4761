// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/array_file.hpp"
#include "experiments/judging/converted_arrays.hpp"
#include "experiments/judging/estimate_source.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// Estimates of one estimator in the arrays of an HDF5 file:
/// `error` {run, scan, d}, or `mean` {run, scan, column} and `truth` {run, scan, column} or
/// {scan, column}; `covariance` {run, scan, d, d}; and, if there are, `time` {scan} or
/// {run, scan} [s], `nis` {run, scan} with `nis_dof` {run, scan}, and the text attribute `names`,
/// the columns of the state as in a CSV file. A scan whose numbers are all NaN is missing. Arrays
/// of NumPy and MATLAB are converted to such a file.
class EstimateArrays final : public EstimateSource {
 public:
  /// `names` are those of the columns, with commas; by default the attribute's. Throws StudyError
  /// if arrays are missing or their axes do not fit.
  EstimateArrays(std::filesystem::path path, std::string cell,
                 const std::optional<std::string>& names = {});

  const std::vector<std::string>& cells() const override { return cells_; }
  const std::vector<std::uint64_t>& runs() const override { return runs_; }
  std::filesystem::path place(std::size_t cell, std::size_t run) const override;
  std::filesystem::path truth_place(std::size_t cell, std::size_t run) const override;
  std::vector<double> times(std::size_t cell, std::size_t run) const override;
  StateRows estimates(std::size_t cell, std::size_t run) const override;
  StateRows truth(std::size_t cell, std::size_t run, const StateShape& shape) const override;
  bool has_common_truths() const override { return truth_.has_value(); }
  bool has_errors() const override { return !truth_.has_value(); }
  TextPairs contents() const override;
  std::vector<std::string> notes() const override { return {}; }

 private:
  /// A dataset of numbers with its axes.
  struct Array {
    std::string name;
    std::string dataset;  ///< its path in the file
    h5::Shape shape;
    bool has_runs = true;  ///< whether the first axis is that of runs
  };

  Array open(const std::string& name, std::size_t axes) const;
  std::optional<Array> find(const std::string& name, std::size_t axes) const;
  void require_order() const;
  void require_axes(const Array& array, const h5::Shape& wanted, std::string_view axes) const;
  /// Throws StudyError that names the array.
  [[noreturn]] void refuse(const std::string& name, const std::string& reason) const;
  std::vector<std::string> names_of_columns(const std::optional<std::string>& given) const;
  StateShape shape_of_names(const std::vector<std::string>& columns) const;
  /// The numbers of one run, or all if the array has no axis of runs.
  std::vector<double> numbers(const Array& array, std::size_t run) const;
  StateRows states_of(const Array& array, std::size_t run, const std::string& place) const;

  std::filesystem::path path_;
  std::unique_ptr<ConvertedArrays> converted_;  ///< of another file than HDF5
  ArrayFile file_;
  std::vector<std::string> cells_;
  std::vector<std::uint64_t> runs_;
  Array states_;  ///< `error` or `mean`
  Array covariance_;
  std::optional<Array> truth_, time_, nis_, nis_dof_;
  StateShape shape_;
};

}  // namespace montecarta::experiments
