// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/check_file.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/forked_reader.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/read_description.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/run_record.hpp"
#include "engine/records/structure.hpp"

#include <span>
#include <string>
#include <vector>

namespace montecarta::engine {
namespace {

/// A dataset whose first axis is that of runs.
struct Rows {
  h5::Handle dataset;
  Element element;
  std::size_t run_bytes;
};

Rows open_rows(const h5::Handle& file, const std::string& name, Element element,
               std::size_t run_bytes) {
  return {h5::open_dataset(file, name), element, run_bytes};
}

void add_run(const Rows& rows, std::size_t i, std::vector<std::byte>& buffer,
             Fingerprint& fingerprint) {
  buffer.resize(rows.run_bytes);
  h5::read_row(rows.dataset, i, rows.element, buffer);
  fingerprint.add(buffer);
}

std::uint64_t fingerprint_of(const std::vector<Rows>& all, std::size_t i) {
  thread_local std::vector<std::byte> buffer;
  Fingerprint fingerprint;
  for (const Rows& rows : all) add_run(rows, i, buffer, fingerprint);
  return fingerprint.value();
}

template <class T>
std::vector<T> per_run(const h5::Handle& file, const std::string& name, Element element,
                       std::size_t runs) {
  std::vector<T> values(runs);
  h5::read(h5::open_dataset(file, name), element, std::as_writable_bytes(std::span(values)));
  return values;
}

/// Compares all runs with their fingerprints. HDF5 reads the numbers, because another program may
/// have packed them.
class RunCheck {
 public:
  RunCheck(const h5::Handle& file, const ResultDescription& description,
           const std::filesystem::path& path)
      : file_(file), d_(description), path_(path), has_record_(description.runs.size()) {}

  void check_cell(const StoredCell& cell) {
    const std::string group = formatted("cells/{}/", cell.label);
    const auto status = per_run<RunStatus>(file_, group + "status", Element::u8, d_.runs.size());
    require_known(status, formatted("{}: cell '{}'", path_, cell.label));
    std::vector<Rows> usual = columns(cell, 0, cell.usual_columns);
    usual.push_back(open_rows(file_, group + "status", Element::u8, 1));
    usual.push_back(open_rows(file_, group + "failure_step", Element::u32, sizeof(std::uint32_t)));
    usual.push_back(open_rows(file_, group + "failure_reason", Element::u8, kFailureReasonBytes));
    compare(group, usual, status);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (is_stored(status[i])) has_record_[i] = true;
    }
    if (cell.full().empty()) return;
    const std::vector<RunStatus> full(
        status.begin(), status.begin() + static_cast<std::ptrdiff_t>(d_.full_runs_here()));
    compare(formatted("{}{}/", group, format::kFull),
            columns(cell, cell.usual_columns, cell.columns.size()), full);
  }

  /// The true paths of the runs that any cell has.
  void check_truth() const {
    if (!d_.has_truth) return;
    std::vector<Rows> rows;
    rows.push_back(open_rows(file_, "truth/pose", Element::f64, d_.times.size() * sizeof(Pose)));
    if (d_.own_landmarks) {
      rows.push_back(open_rows(file_, "truth/landmarks", Element::f64,
                               d_.landmarks.size() * sizeof(Eigen::Vector2d)));
    }
    const auto stored =
        per_run<std::uint64_t>(file_, "truth/fingerprint", Element::u64, d_.runs.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
      if (has_record_[i] && fingerprint_of(rows, i) != stored[i]) refuse("truth/", i);
    }
  }

 private:
  std::vector<Rows> columns(const StoredCell& cell, std::size_t first, std::size_t last) const {
    std::vector<Rows> rows;
    for (std::size_t c = first; c < last; ++c) {
      const Column& column = cell.columns[c];
      rows.push_back(open_rows(file_, cell.dataset_of(c), column.element, column.bytes()));
    }
    return rows;
  }

  /// Throws StudyError unless the fingerprints in a group are those of the rows, and 0 where a run
  /// has none.
  void compare(const std::string& group, const std::vector<Rows>& rows,
               const std::vector<RunStatus>& status) const {
    const auto stored =
        per_run<std::uint64_t>(file_, group + "fingerprint", Element::u64, status.size());
    for (std::size_t i = 0; i < status.size(); ++i) {
      if ((is_stored(status[i]) ? fingerprint_of(rows, i) : 0) != stored[i]) refuse(group, i);
    }
  }

  [[noreturn]] void refuse(const std::string& group, std::size_t i) const {
    throw StudyError(
        "{}: changed by another program (in '/{}' run {} does not fit its fingerprint): take the "
        "file as montecarta wrote it, or run the study again",
        path_, group, d_.runs[i]);
  }

  const h5::Handle& file_;
  const ResultDescription& d_;
  const std::filesystem::path& path_;
  std::vector<bool> has_record_;  ///< {run} whether any cell has the run
};

/// Throws StudyError if the structure or a run of a file without a seal has changed.
void check_unsealed(const std::filesystem::path& path) {
  const h5::Handle file = h5::open_file(path);
  const std::uint64_t minor_version = minor_version_of(file, path);
  check_structure(file, minor_version, path);
  const ResultDescription description = read_description(file, path);
  if (minor_version < format::kMinorOfSeal) return;
  RunCheck check(file, description, path);
  for (const StoredCell& cell : description.cells) check.check_cell(cell);
  check.check_truth();
}

}  // namespace

Seal check_file(const std::filesystem::path& path) {
  const Seal seal = check_seal(path);
  if (seal == Seal::holds) return seal;
  ForkedReader(path, [&](std::string_view) {
    check_unsealed(path);
    return "";
  }).ask("");
  return seal;
}

ResultDescription read_description(const std::filesystem::path& path) {
  check_file(path);
  return read_description(h5::open_file(path), path);
}

}  // namespace montecarta::engine
