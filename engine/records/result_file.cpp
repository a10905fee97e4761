// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_file.hpp"

#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_dataset.hpp"
#include "engine/records/seal.hpp"
#include "engine/records/sum_groups.hpp"
#include "engine/visible_text.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace montecarta::engine {
struct ResultFile::Contents {
  std::filesystem::path path;
  Seal seal;
  h5::Handle file;
  PosixFile bytes;
  ResultDescription description;
  std::optional<RunDataset> truth, own_landmarks;
  /// Every column of every cell, opened once.
  std::map<std::string, std::map<std::string, RunDataset, std::less<>>, std::less<>> columns;
  std::optional<ResultSlabs> slabs;  ///< nullopt if the file has no seal

  explicit Contents(const std::filesystem::path& given)
      : path(given),
        seal(check_seal(path)),
        file(h5::open_file(path)),
        bytes(path, PosixFile::Mode::read),
        description(read_description(file, path)) {
    if (description.has_truth) truth = open("truth/pose");
    if (description.own_landmarks) own_landmarks = open("truth/landmarks");
    for (const StoredCell& cell : description.cells) {
      open_columns(cell, "", cell.columns);
      open_columns(cell, std::string(format::kFull) + "/", cell.full_columns);
    }
    if (seal == Seal::holds) slabs = find_slabs(path, description);
  }

  RunDataset open(const std::string& name) const {
    h5::Handle dataset = h5::open_dataset(file, name);
    const bool is_here = h5::file_name(dataset) == h5::file_name(file);  // no link to another file
    return RunDataset(std::move(dataset), is_here ? &bytes : nullptr);
  }

  void open_columns(const StoredCell& cell, const std::string& group,
                    const std::vector<Column>& all) {
    const std::string place = "cells/" + cell.label + "/" + group;
    for (const Column& column : all)
      columns[cell.label].emplace(column.name, open(place + column.name));
  }

  const RunDataset& column(const StoredCell& cell, std::string_view name) const {
    const auto of_cell = columns.find(cell.label);
    if (of_cell != columns.end()) {
      const auto found = of_cell->second.find(name);
      if (found != of_cell->second.end()) return found->second;
    }
    throw RunError(path.string() + ": cell '" + cell.label + "' has no column '" +
                   std::string(name) +
                   "' (record.columns did not ask for it): run the study again with it");
  }

  template <class T>
  std::vector<T> per_run(const std::string& name, Element element) const {
    std::vector<T> values(description.runs.size());
    h5::read(h5::open_dataset(file, name), element, std::as_writable_bytes(std::span(values)));
    return values;
  }
};

namespace {

const std::filesystem::path& existing(const std::filesystem::path& path) {
  if (is_there(path)) return path;
  throw StudyError(path.string() + ": no such file" +
                   (is_there(part_of(path))
                        ? " (the work is unfinished): read " + part_of(path).string() +
                              ", or finish it with 'montecarta run --resume'"
                        : ": check the spelling"));
}

}  // namespace

ResultFile::ResultFile(const std::filesystem::path& path)
    : contents_(std::make_unique<Contents>(existing(path))) {}
ResultFile::~ResultFile() = default;
ResultFile::ResultFile(ResultFile&&) noexcept = default;

const std::filesystem::path& ResultFile::path() const { return contents_->path; }
const ResultDescription& ResultFile::description() const { return contents_->description; }
const std::string& ResultFile::study_name() const { return description().study_name; }
const std::string& ResultFile::title() const { return description().title; }
const std::string& ResultFile::study_text() const { return description().study_text; }
const std::string& ResultFile::study_sha256() const { return description().study_sha256; }
std::uint64_t ResultFile::seed() const { return description().seed; }
std::uint64_t ResultFile::study_runs() const { return description().study_runs; }
const std::vector<std::uint64_t>& ResultFile::runs() const { return description().runs; }
const std::vector<double>& ResultFile::times() const { return description().times; }
const std::vector<std::uint32_t>& ResultFile::scan_rows() const { return description().scan_rows; }
const std::vector<double>& ResultFile::scan_times() const { return description().scan_times; }
const std::vector<std::pair<double, double>>& ResultFile::landmarks() const {
  return description().landmarks;
}
const std::vector<std::pair<double, double>>& ResultFile::waypoints() const {
  return description().waypoints;
}
const std::vector<ReferencePath>& ResultFile::references() const {
  return description().references;
}
bool ResultFile::has_truth() const { return description().has_truth; }
bool ResultFile::has_errors() const {
  return has_truth() ||
         std::ranges::any_of(cells(), [](const StoredCell& cell) { return cell.has("error"); });
}
const TextPairs& ResultFile::scenario() const { return description().scenario; }
const TextPairs& ResultFile::provenance() const { return description().provenance; }
const std::vector<StoredCell>& ResultFile::cells() const { return description().cells; }

std::vector<RunStatus> ResultFile::status(const StoredCell& cell) const {
  auto statuses = contents_->per_run<RunStatus>("cells/" + cell.label + "/status", Element::u8);
  expect_known(statuses, path().string() + ": cell '" + cell.label + "'");
  return statuses;
}

void ResultFile::expect_whole(const StoredCell& cell, std::size_t i) const {
  const PosixFile& bytes = contents_->bytes;
  if (!contents_->slabs) return;
  const auto c = static_cast<std::size_t>(&cell - cells().data());
  thread_local std::vector<std::byte> buffer;
  const CellSlabs& slabs = contents_->slabs->cells.at(c);
  if (run_is_whole(bytes, slabs, i, buffer) &&
      (!is_stored(status_of(bytes, slabs, i)) ||
       truth_is_whole(bytes, *contents_->slabs, i, buffer))) {
    return;
  }
  throw StudyError(
      path().string() + ": cell '" + cell.label + "', run " + std::to_string(runs()[i]) +
      ": damaged (its bytes do not fit its fingerprint): take a copy that is whole, or "
      "run the study again");
}

std::vector<std::string> ResultFile::failure_reasons(const StoredCell& cell) const {
  const h5::Handle dataset =
      h5::open_dataset(contents_->file, "cells/" + cell.label + "/failure_reason");
  std::string texts(runs().size() * kFailureReasonBytes, '\0');
  h5::read(dataset, Element::u8, std::as_writable_bytes(std::span(texts)));
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < runs().size(); ++i)
    reasons.push_back(visible(texts.substr(i * kFailureReasonBytes, kFailureReasonBytes).c_str()));
  return reasons;
}

std::vector<std::uint32_t> ResultFile::failure_steps(const StoredCell& cell) const {
  return contents_->per_run<std::uint32_t>("cells/" + cell.label + "/failure_step", Element::u32);
}

std::vector<double> ResultFile::cpu_seconds(const StoredCell& cell) const {
  return contents_->per_run<double>("timing/" + cell.label + "/cpu_seconds", Element::f64);
}

double ResultFile::wall_seconds() const {
  double seconds = 0.0;
  h5::read(h5::open_dataset(contents_->file, "timing/wall_seconds"), Element::f64,
           std::as_writable_bytes(std::span(&seconds, 1)));
  return seconds;
}

std::vector<std::uint64_t> ResultFile::fingerprints(const StoredCell& cell) const {
  return contents_->per_run<std::uint64_t>("cells/" + cell.label + "/fingerprint", Element::u64);
}

std::vector<SumGroup> ResultFile::sum_groups(const StoredCell& cell) const {
  if (!contents_->slabs) {
    throw StudyError(path().string() +
                     ": its sums cannot be checked (another program rewrote the file, which has "
                     "lost its seal): use the file as montecarta wrote it");
  }
  const auto c = static_cast<std::size_t>(&cell - cells().data());
  return find_groups(contents_->bytes, contents_->slabs->sums.at(c), *description().sums);
}

std::vector<std::uint64_t> ResultFile::sums(const SumGroup& group) const {
  return read_sums(contents_->bytes, group);
}

std::vector<double> ResultFile::cpu_seconds_in_sums(const StoredCell& cell) const {
  const SummedRuns& sums = *description().sums;
  std::vector<double> seconds(sums.last_run - sums.first_run);
  h5::read(h5::open_dataset(contents_->file,
                            "timing/" + cell.label + "/" + std::string(format::kSumSeconds)),
           Element::f64, std::as_writable_bytes(std::span(seconds)));
  return seconds;
}

bool ResultFile::holds(const StoredCell& cell, std::string_view column, std::size_t i) const {
  return cell.has(column) || (i < description().full_runs_here() && cell.find(column) != nullptr);
}

void ResultFile::read(const StoredCell& cell, std::string_view column, std::size_t i,
                      std::span<double> out) const {
  contents_->column(cell, column).read(i, out);
}

void ResultFile::read(const StoredCell& cell, std::string_view column, std::size_t i,
                      std::span<std::uint32_t> out) const {
  contents_->column(cell, column).read(i, out);
}

void ResultFile::read_truth(std::size_t i, std::span<double> out) const {
  expect(contents_->truth.has_value(), "the truth was asked for where nobody knows it");
  contents_->truth->read(i, out);
}

bool ResultFile::has_own_landmarks() const { return description().own_landmarks; }

std::vector<Eigen::Vector2d> ResultFile::landmarks_of(std::size_t i) const {
  std::vector<Eigen::Vector2d> points;
  for (const auto& [x, y] : landmarks()) points.emplace_back(x, y);
  if (!has_own_landmarks()) return points;
  std::vector<double> coordinates(2 * points.size());
  contents_->own_landmarks->read(i, std::span(coordinates));
  for (std::size_t l = 0; l < points.size(); ++l) {
    points[l] = {coordinates[2 * l], coordinates[2 * l + 1]};
  }
  return points;
}

}  // namespace montecarta::engine
