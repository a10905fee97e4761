// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/run_reader.hpp"

#include "analysis/run/study_facts.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

constexpr std::string_view kFinalMapSeen = "final_map_seen";
constexpr double kRoundingOfCounts = 1e-6;  // [landmarks] rounding error that a map size may have

/// Number of scans with joint estimates before scan number `first`.
std::size_t joint_scans_before(const ResultFile& file, std::size_t first) {
  const std::vector<std::uint32_t>& all = file.description().joint_scans;
  return static_cast<std::size_t>(std::ranges::lower_bound(all, first) - all.begin());
}

/// The first scan that is read.
std::size_t first_scan_of(const ResultFile& file, Reach reach) {
  return reach == Reach::full_run ? 0 : judged_scans_of(file).first;
}

}  // namespace

JudgedScans judged_scans_of(const ResultFile& file) {
  JudgedScans judged{study_facts_of(file).judge_from};
  if (judged.from == 0.0) return judged;
  const std::vector<double>& times = file.scan_times();
  judged.first =
      static_cast<std::size_t>(std::ranges::lower_bound(times, judged.from) - times.begin());
  const std::string problem =
      formatted("{}: study.judge_from = {} s ", file.path(), compact(judged.from));
  if (!file.description().drives.empty()) {
    throw StudyError(problem + "of drives that have times of their own: choose another file");
  }
  if (judged.first == times.size()) {
    throw StudyError(problem + "is behind the last scan (nothing is judged): choose another file");
  }
  return judged;
}

std::vector<std::uint32_t> judged_joint_scans(const ResultFile& file) {
  const auto first = static_cast<std::uint32_t>(judged_scans_of(file).first);
  std::vector<std::uint32_t> judged = file.description().joint_scans;
  std::erase_if(judged, [first](std::uint32_t scan) { return scan < first; });
  for (std::uint32_t& scan : judged) scan -= first;
  return judged;
}

RunReader::RunReader(const ResultFile& file, const StoredCell& cell, Reach reach)
    : file_(&file),
      cell_(&cell),
      reach_(reach),
      first_(first_scan_of(file, reach)),
      first_joint_(joint_scans_before(file, first_)),
      cpu_seconds_(file.cpu_seconds(cell)) {}

bool RunReader::has(std::string_view column, std::size_t i) const {
  return cell_->has(column) || (reach_ == Reach::full_run && file_->holds(*cell_, column, i));
}

std::size_t RunReader::scans_of(std::size_t i) const {
  return drive_of_run(*file_, file_->runs()[i]).scan_times.size();
}

void RunReader::keep_scans(std::size_t width, std::size_t i, std::vector<double>& rows) const {
  const auto scan_rows = drive_of_run(*file_, file_->runs()[i]).scan_rows.subspan(first_);
  for (std::size_t s = 0; s < scan_rows.size(); ++s) {
    if (scan_rows[s] == s) continue;
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(scan_rows[s] * width), width,
                rows.begin() + static_cast<std::ptrdiff_t>(s * width));
  }
  rows.resize(scan_rows.size() * width);
}

void RunReader::read_truth(std::size_t i, RunRows& rows) const {
  rows.earlier_truth.clear();
  if (!file_->has_truth()) return rows.truth.clear();
  rows.truth.resize(file_->times().size() * 3);
  file_->read_truth(i, rows.truth);
  for (const std::uint32_t row : std::span(file_->description().scan_rows).first(first_)) {
    const auto pose = rows.truth.begin() + std::ptrdiff_t{3} * row;
    rows.earlier_truth.insert(rows.earlier_truth.end(), pose, pose + 3);
  }
  keep_scans(3, i, rows.truth);
}

void RunReader::read_at_scans(std::string_view column, std::size_t width, std::size_t i,
                              std::vector<double>& out) const {
  if (!has(column, i)) return out.clear();
  out.resize(file_->times().size() * width);
  file_->read(*cell_, column, i, std::span(out));
  keep_scans(width, i, out);
}

void RunReader::read_rows(std::string_view column, std::size_t width, std::size_t i,
                          std::vector<double>& out) const {
  if (!has(column, i)) return out.clear();
  out.resize(file_->times().size() * width);
  file_->read(*cell_, column, i, std::span(out));
  out.resize(drive_of_run(*file_, file_->runs()[i]).row_times.size() * width);
}

void RunReader::read_path(std::size_t i, PathRows& out) const {
  const auto references = drive_of_run(*file_, file_->runs()[i]).references;
  out = {};
  if (references.empty()) return;
  read_rows("pose_mean", 3, i, out.spread.mean);
  read_rows("pose_mean_mixture", 3, i, out.mixture.mean);
  const auto is_known = [](const ReferencePath& path) { return !path.covariance.empty(); };
  if (std::ranges::none_of(references, is_known)) return;
  read_rows("pose_covariance", 9, i, out.spread.covariance);
  read_rows("pose_covariance_mixture", 9, i, out.mixture.covariance);
}

void RunReader::read_final_map(std::size_t i, RunRows& rows) const {
  rows.final_map.reset();
  const bool is_final = cell_->has(kFinalMapSeen);
  const std::string prefix = is_final ? "final_map_" : "map_";
  if (!cell_->has(prefix + "seen")) return;
  const std::size_t landmarks = cell_->find(prefix + "seen")->shape.back();
  // The map size may be a mean over weights that add up to one but for rounding.
  if (!rows.map_size.empty() &&
      rows.map_size.back() > static_cast<double>(landmarks) + kRoundingOfCounts)
    return;                 // record.map_rows left some rows out
  std::vector<double> all;  // maps of every scan, or of the last one
  const auto last = [&](const char* name, std::size_t width) {
    read_whole(prefix + name, i, all);
    const std::size_t maps = is_final ? 1 : scans_of(i);
    return std::span<const double>(all).first(maps * landmarks * width).last(landmarks * width);
  };
  FinalMap& map = rows.final_map.emplace();
  for (const double one : last("seen", 1)) map.seen.push_back(one != 0.0 ? 1 : 0);
  const auto mean = last("mean", 2);
  for (std::size_t l = 0; l < landmarks; ++l) map.mean.emplace_back(mean[2 * l], mean[2 * l + 1]);
  const auto covariance = last("covariance", 4);
  for (std::size_t l = 0; l < landmarks; ++l) {
    map.covariance.emplace_back(Eigen::Map<const Eigen::Matrix2d>(covariance.data() + 4 * l));
  }
}

void RunReader::read_whole(std::string_view column, std::size_t i, std::vector<double>& out) const {
  if (!cell_->has(column)) return out.clear();
  out.resize(cell_->find(column)->elements());
  file_->read(*cell_, column, i, std::span(out));
}

void RunReader::read_without(std::string_view column, std::size_t left_out, std::size_t width,
                             std::size_t i, std::vector<double>& out) const {
  read_whole(column, i, out);
  if (out.empty()) return;
  out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(left_out * width));
}

void RunReader::read_joint(std::size_t i, JointRows& out) const {
  const Column* mean = cell_->find("joint_mean");
  const std::size_t states = mean == nullptr ? 0 : mean->shape.back();
  read_without("joint_mean", first_joint_, states, i, out.mean);
  read_without("joint_covariance", first_joint_, states * states, i, out.covariance);
}

void RunReader::read_errors(std::size_t i, ErrorRows& out) const {
  const Column* error = cell_->find("error");
  const std::size_t components = error == nullptr ? 0 : error->shape.back();
  read_without("error", first_, components, i, out.value);
  read_without("error_covariance", first_, components * components, i, out.covariance);
  for (std::size_t k = 0; k < kErrorConventions.size(); ++k) {
    read_without(kErrorConventions[k].column, first_, 1, i, out.nees_by[k]);
  }
}

template <class Number>
void RunReader::read_scans(std::string_view column, std::size_t width, std::size_t i,
                           std::vector<Number>& out) const {
  if (!has(column, i)) return out.clear();
  if (cell_->find(column)->axes.front() != engine::Axis::scan) {
    throw StudyError(
        "{}: cells/{}/{} has other axes than it should (the file is damaged): take a copy that is "
        "whole, or run the study again",
        file_->path(), cell_->label, column);
  }
  out.resize(file_->scan_times().size() * width);
  file_->read(*cell_, column, i, std::span(out));
  out.resize(scans_of(i) * width);
  out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(first_ * width));
}

void RunReader::expect_particles(const RunRows& rows) const {
  std::uint32_t largest = 0;
  for (const std::uint32_t parent : rows.ancestor) largest = std::max(largest, parent);
  if (rows.ancestor.empty() || largest < cell_->particles) return;
  throw StudyError(
      "{}: cell '{}', run {}: an ancestor is none of the particles (the file is damaged): run the "
      "study again",
      file_->path(), cell_->label, rows.run);
}

void RunReader::read_particles(std::size_t i, RunRows& rows) const {
  rows.ess.clear();
  rows.resampled.clear();
  if (cell_->particles > 0) {
    read_scans("ess", 1, i, rows.ess);
    read_scans("resampled", 1, i, rows.resampled);
  }
  read_scans("ancestor", cell_->particles, i, rows.ancestor);
  expect_particles(rows);
  read_scans("particle_pose", 3 * cell_->particles, i, rows.particle_pose);
  read_scans("log_weight", cell_->particles, i, rows.log_weight);
}

void RunReader::read(std::size_t i, RunRows& rows) const {
  file_->expect_whole(*cell_, i);
  read_truth(i, rows);
  read_at_scans("pose_mean", 3, i, rows.spread.mean);
  read_at_scans("pose_covariance", 9, i, rows.spread.covariance);
  read_at_scans("pose_mean_mixture", 3, i, rows.mixture.mean);
  read_at_scans("pose_covariance_mixture", 9, i, rows.mixture.covariance);
  read_scans("numerical_faults", 1, i, rows.numerical_faults);
  read_scans("association_correct", 1, i, rows.association.correct);
  read_scans("association_wrong", 1, i, rows.association.wrong);
  read_scans("association_new_again", 1, i, rows.association.new_again);
  read_scans("association_missed", 1, i, rows.association.missed);
  read_scans("association_clutter", 1, i, rows.association.clutter);
  read_scans("nis", 1, i, rows.nis);
  read_scans("nis_dof", 1, i, rows.nis_dof);
  read_path(i, rows.path);
  read_scans("map_size", 1, i, rows.map_size);
  read_scans("rotation_information", 1, i, rows.rotation_information);
  read_scans("evolution_evaluations", 1, i, rows.evolution.evaluations);
  read_scans("evolution_generations", 1, i, rows.evolution.generations);
  read_scans("evolution_gain", 1, i, rows.evolution.gain);
  read_scans("evolution_displacement", 1, i, rows.evolution.displacement);
  read_final_map(i, rows);
  read_joint(i, rows.joint);
  read_errors(i, rows.error);
  rows.run = file_->runs()[i];
  rows.landmarks = file_->landmarks_of(i);
  rows.cpu_seconds = cpu_seconds_[i];
  read_particles(i, rows);
}

RunRows read_run(const ResultFile& file, const StoredCell& cell, std::size_t i) {
  RunRows rows;
  RunReader(file, cell, Reach::full_run).read(i, rows);
  return rows;
}

}  // namespace montecarta::analysis
