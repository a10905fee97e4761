// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/estimate_files.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/read_rows.hpp"
#include "experiments/text/words.hpp"

#include <utility>

namespace montecarta::experiments {
namespace {

/// SHA-256 of the contents of all files, in their order, and of the innovations beside each.
std::string sha256_of(const std::vector<std::filesystem::path>& files) {
  std::string all;
  for (const std::filesystem::path& file : files) {
    all += sha256(whole_file(file)) + "\n";
    if (const auto beside = innovations_beside(file)) all += sha256(whole_file(*beside)) + "\n";
  }
  return sha256(all);
}

}  // namespace

EstimateFiles::EstimateFiles(JudgedFiles files, const Reading& how)
    : files_(std::move(files)), how_(how) {
  for (const EstimatorFiles& cell : files_.cells) cells_.push_back(cell.cell);
}

std::vector<double> EstimateFiles::times(std::size_t cell, std::size_t run) const {
  return times_in(place(cell, run), how_.equal_times);
}

StateRows EstimateFiles::estimates(std::size_t cell, std::size_t run) const {
  const std::filesystem::path path = place(cell, run);
  StateRows rows = read_estimates(path, how_.equal_times);
  if (const auto beside = innovations_beside(path)) {
    read_innovations(*beside, path, how_.tolerance, rows);
  }
  return rows;
}

StateRows EstimateFiles::truth(std::size_t cell, std::size_t run, const StateShape& shape) const {
  if (how_.is_pair) {
    const std::filesystem::path path = truth_place(cell, run);
    StateRows other = read_estimates(path, how_.equal_times);
    if (other.shape == shape && !other.time.empty()) return other;
    throw StudyError(path.string() + (other.time.empty() ? ": no rows" : ": another state") + " (" +
                     place(cell, run).string() + " has " + joined(shape.columns, ",") +
                     ", and both are compared): give both estimators the same state and times");
  }
  return read_truth(truth_place(cell, run), shape,
                    {.equal = how_.equal_times,
                     .with_covariance = how_.truth_covariance,
                     .prefix = how_.own_truth == OwnTruth::columns ? kTruthPrefix : ""});
}

TextPairs EstimateFiles::contents() const {
  TextPairs all;
  if (!files_.names.empty()) all.emplace_back("names of runs", joined(files_.names));
  if (has_common_truths()) all.emplace_back("truth_sha256", sha256_of(files_.truth));
  for (const EstimatorFiles& cell : files_.cells)
    all.emplace_back("sha256 of " + cell.cell, sha256_of(cell.of_run));
  return all;
}

std::vector<std::string> EstimateFiles::notes() const {
  std::string note = note_on_names(files_);
  if (note.empty()) return {};
  return {std::move(note)};
}

}  // namespace montecarta::experiments
