// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/estimate_arrays.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_format.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/visible_text.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/judging/state_columns.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

namespace montecarta::experiments {
namespace {

std::string axes_text(const h5::Shape& shape) {
  std::vector<std::string> lengths;
  for (const auto length : shape) lengths.push_back(std::to_string(length));
  return formatted("{{{}}}", joined(lengths));
}

bool is_all_nan(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isnan(x); });
}

bool is_all_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

/// The header of a CSV file with these columns of a state of `dimension` components.
std::vector<std::string> header_of(const std::vector<std::string>& columns, std::size_t dimension) {
  std::vector<std::string> header = {kTimeColumn};
  header.insert(header.end(), columns.begin(), columns.end());
  for (std::size_t i = 0; i < dimension; ++i) {
    for (std::size_t j = 0; j < dimension; ++j) header.push_back(formatted("cov_{}_{}", i, j));
  }
  return header;
}

/// Returns the file unless it is a result, or has an array under the plural of its name.
const ArrayFile& checked(const ArrayFile& file, const std::filesystem::path& path) {
  const auto filetype = file.texts("filetype");
  if (filetype && !filetype->empty() && filetype->front() == format::kFiletype) {
    throw StudyError(path.string() +
                     ": is a result already (judge reads arrays): use montecarta analyze");
  }
  for (const std::string name : {"error", "mean", "covariance", "truth"}) {
    if (file.has(name) || !file.has(name + "s")) continue;
    throw StudyError("{}: has {}s (an array is called {}): rename it", path.string(), name, name);
  }
  return file;
}

}  // namespace

EstimateArrays::EstimateArrays(std::filesystem::path path, std::string cell,
                               const std::optional<std::string>& names)
    : path_(std::move(path)),
      converted_(are_foreign_arrays(path_) ? std::make_unique<ConvertedArrays>(path_) : nullptr),
      file_(converted_ ? converted_->path() : path_),
      cells_{std::move(cell)},
      states_(open(checked(file_, path_).has("error") ? "error" : "mean", 3)),
      covariance_(open("covariance", 4)),
      truth_(find("truth", 3)),
      time_(find("time", 2)),
      nis_(find("nis", 2)),
      nis_dof_(find("nis_dof", 2)) {
  check_label(cells_.front());
  require_order();
  const auto runs = states_.shape[0], scans = states_.shape[1], d = covariance_.shape[3];
  require_axes(covariance_, {runs, scans, d, d}, "{run, scan, d, d}");
  if (runs == 0 || scans == 0 || d == 0) refuse(states_.name, "is empty: write a run at least");
  if (states_.name == "error") {
    require_axes(states_, {runs, scans, d}, "{run, scan, d}");
    if (file_.has("mean")) refuse("mean", "is beside error (one is judged): remove one of them");
    if (truth_) refuse("truth", "is beside error (which one is it?): remove one of them");
  } else if (!truth_) {
    refuse("truth", "is missing (mean is compared with it): add it, or write error");
  } else {
    require_axes(*truth_, {runs, scans, states_.shape[2]}, "{run, scan, column}, as mean");
  }
  if (time_) require_axes(*time_, {runs, scans}, "{run, scan}");
  if (nis_.has_value() != nis_dof_.has_value()) {
    refuse(nis_ ? "nis" : "nis_dof", "needs nis and nis_dof together: add the other one");
  }
  if (nis_) require_axes(*nis_, {runs, scans}, "{run, scan}");
  if (nis_dof_) require_axes(*nis_dof_, {runs, scans}, "{run, scan}");
  runs_.resize(runs);
  std::iota(runs_.begin(), runs_.end(), std::uint64_t{0});
  shape_ = shape_of_names(names_of_columns(names));
}

/// Throws StudyError if MATLAB or Julia wrote the arrays, which turn the order of axes round.
void EstimateArrays::require_order() const {
  const h5::Shape& of = states_.shape;
  const bool is_turned = covariance_.shape == h5::Shape{of[0], of[0], of[1], of[2]};
  if (!is_turned || covariance_.shape == h5::Shape{of[0], of[1], of[2], of[2]}) return;
  refuse("covariance",
         formatted(
             "has the axes {} (the order of MATLAB and Julia, in which a file has them turned "
             "round): write permute(covariance, [4 3 2 1]), and the other arrays turned round too",
             axes_text(covariance_.shape)));
}

void EstimateArrays::refuse(const std::string& name, const std::string& reason) const {
  throw StudyError("{}: {} {}", path_, name, reason);
}

/// Opens an array of `axes` axes, of which that of runs may be left out, or have length 1, if all
/// runs share it. With `save -hdf5` Octave writes a group that has the array as `value`.
EstimateArrays::Array EstimateArrays::open(const std::string& name, std::size_t axes) const {
  if (!file_.has(name)) {
    refuse(name, formatted("is missing (arrays are error, or mean and truth, with covariance; the "
                           "file has {}): write it, as experiments/JUDGING_ESTIMATES.md shows",
                           joined(file_.members())));
  }
  const bool is_of_octave = file_.is_group(name) && file_.has(name + "/value");
  const std::string dataset = is_of_octave ? name + "/value" : name;
  if (file_.is_group(dataset)) refuse(name, "is a group (an array is needed): write an array");
  Array array{name, dataset, file_.shape(dataset)};
  const bool may_be_shared = name == "truth" || name == "time";
  if (may_be_shared && array.shape.size() == axes && array.shape[0] == 1)
    array.shape.erase(array.shape.begin());
  array.has_runs = array.shape.size() == axes;
  if (!array.has_runs && !(may_be_shared && array.shape.size() + 1 == axes)) {
    refuse(name, formatted("has the axes {} ({} are needed, the first of runs): give an array of "
                           "one run an axis of length 1",
                           axes_text(array.shape), axes));
  }
  return array;
}

std::optional<EstimateArrays::Array> EstimateArrays::find(const std::string& name,
                                                          std::size_t axes) const {
  if (!file_.has(name)) return std::nullopt;
  return open(name, axes);
}

void EstimateArrays::require_axes(const Array& array, const h5::Shape& wanted,
                                  std::string_view axes) const {
  const std::size_t first = array.has_runs ? 0 : 1;
  if (std::ranges::equal(array.shape, std::span(wanted).subspan(first))) return;
  refuse(
      array.name,
      formatted("has the axes {} ({} is {}): give all arrays the same runs, scans and components",
                axes_text(array.shape), axes, axes_text(wanted)));
}

/// The names of the columns: those given, or else those of the attribute `names`, or else e0, e1,
/// ...
std::vector<std::string> EstimateArrays::names_of_columns(
    const std::optional<std::string>& given) const {
  if (given) return split(*given, ',');
  std::vector<std::string> columns;
  if (const auto names = file_.texts("names")) {
    for (const std::string& text : *names) {
      for (const std::string& name : split(text, ',')) columns.push_back(name);
    }
    if (columns.empty()) refuse("names", "are no texts: write x_m,y_m or a list of texts");
  } else if (file_.has("names")) {
    refuse(
        "names",
        "is an array (a text attribute of the file is needed): write it as one, or give --names");
  } else if (!has_errors()) {
    refuse("names",
           "is missing (mean has columns, such as x_m,y_m,heading_rad): write it as a text "
           "attribute of the file, or give --names");
  } else {
    const auto width = static_cast<std::size_t>(states_.shape[2]);
    for (std::size_t k = 0; k < width; ++k) columns.push_back(formatted("e{}", k));
  }
  return columns;
}

/// The shape of a state with columns of these names.
StateShape EstimateArrays::shape_of_names(const std::vector<std::string>& columns) const {
  const auto width = static_cast<std::size_t>(states_.shape[2]);
  const auto d = static_cast<std::size_t>(covariance_.shape[2]);
  const auto is_unprintable = [](const std::string& name) { return name != visible(name); };
  if (std::ranges::any_of(columns, is_unprintable)) {
    refuse("names", "have characters that cannot be printed: write plain names");
  }
  if (columns.size() != width) {
    refuse("names", formatted("has {} columns ({} has {}): name each column once", columns.size(),
                              states_.name, width));
  }
  StateShape shape = estimate_fields(header_of(columns, d), path_.string() + ": names").shape;
  if (shape.dimension() != d) {
    refuse("covariance", formatted("has {} components (the state has {}): write that of the error",
                                   d, shape.dimension()));
  }
  if (shape.columns != columns) {
    refuse("names", "are not those of montecarta: write " + joined(shape.columns, ","));
  }
  if (!has_errors()) return shape;
  shape.kind = StateKind::vector;
  shape.columns = shape.components;
  return shape;
}

std::vector<double> EstimateArrays::numbers(const Array& array, std::size_t run) const {
  return file_.numbers(array.dataset,
                       array.has_runs ? std::optional<std::size_t>(run) : std::nullopt);
}

/// The states of a run at the scans that have one, with their times and, as lines, their scans.
/// Throws StudyError if some numbers of a state are missing, or times do not increase.
StateRows EstimateArrays::states_of(const Array& array, std::size_t run,
                                    const std::string& place) const {
  const std::size_t width = states_.shape[2];
  const std::vector<double> all = numbers(array, run);
  const std::vector<double> time = time_ ? numbers(*time_, run) : std::vector<double>();
  StateRows rows{.shape = shape_};
  for (std::size_t s = 0; s < states_.shape[1]; ++s) {
    const auto state = std::span(all).subspan(s * width, width);
    if (is_all_nan(state)) continue;
    const std::string scan = formatted("{}:{}", place, s);
    if (!is_all_finite(state)) {
      throw StudyError(
          "{}: some numbers of {} are not finite (a scan is missing if all are NaN): give all, or "
          "none",
          scan, array.name);
    }
    const double at = time.empty() ? static_cast<double>(s) : time[s];
    if (!std::isfinite(at)) {
      throw StudyError("{}: time {} is not finite (the scan has a state): write its time in s",
                       scan, to_text(at));
    }
    if (!rows.time.empty() && !(at > rows.time.back())) {
      throw StudyError(
          "{}: time {} s is not later than that of the scan before: sort the scans by time", scan,
          to_text(at));
    }
    rows.time.push_back(at);
    rows.line.push_back(s);
    rows.state.emplace_back(
        Eigen::VectorXd::Map(state.data(), static_cast<Eigen::Index>(state.size())));
    if (shape_.kind == StateKind::pose_in_space) normalise_quaternion(rows.state.back(), scan);
  }
  return rows;
}

std::filesystem::path EstimateArrays::place(std::size_t /*cell*/, std::size_t run) const {
  return formatted("{} (run {}, scan)", path_, run);
}

std::filesystem::path EstimateArrays::truth_place(std::size_t /*cell*/, std::size_t run) const {
  return formatted("{} (truth of run {}, scan)", path_, run);
}

std::vector<double> EstimateArrays::times(std::size_t cell, std::size_t run) const {
  return states_of(states_, run, place(cell, run)).time;
}

StateRows EstimateArrays::estimates(std::size_t cell, std::size_t run) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  StateRows rows = states_of(states_, run, place(cell, run));
  const std::vector<double> covariance = numbers(covariance_, run);
  const auto d = static_cast<Eigen::Index>(shape_.dimension());
  for (const std::size_t s : rows.line) {
    const double* const first = covariance.data() + s * static_cast<std::size_t>(d * d);
    rows.covariance.emplace_back(Eigen::Map<const RowMajor>(first, d, d));
  }
  if (!nis_) return rows;
  const std::vector<double> nis = numbers(*nis_, run), dof = numbers(*nis_dof_, run);
  for (const std::size_t s : rows.line) {
    const bool is_known = !std::isnan(nis[s]);
    const std::string scan = formatted("{}:{}", place(cell, run), s);
    rows.nis.push_back(is_known ? nis[s] : 0.0);
    rows.nis_dof.push_back(is_known ? checked_dof(nis[s], dof[s], scan) : 0);
  }
  return rows;
}

StateRows EstimateArrays::truth(std::size_t cell, std::size_t run,
                                const StateShape& /*shape*/) const {
  expect(truth_.has_value(), "errors have no truth");
  StateRows rows = states_of(*truth_, run, truth_place(cell, run));
  if (!rows.time.empty()) return rows;
  refuse("truth", formatted("of run {} is NaN at all scans: give true states", run));
}

TextPairs EstimateArrays::contents() const {
  std::string all;
  for (const Array* array : {&states_, &covariance_, truth_ ? &*truth_ : nullptr,
                             time_ ? &*time_ : nullptr, nis_ ? &*nis_ : nullptr}) {
    for (std::size_t run = 0; array != nullptr && run < (array->has_runs ? runs_.size() : 1);
         ++run) {
      const std::vector<double> values = numbers(*array, run);
      const auto bytes = std::as_bytes(std::span(values));
      all += sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) + "\n";
    }
  }
  return {{"arrays_sha256", sha256(all)}};
}

}  // namespace montecarta::experiments
