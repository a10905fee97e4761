// SPDX-License-Identifier: BSD-3-Clause
// NEES along a recorded drive, by references with known errors.
#include "analysis/metrics/drive.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

double median_of_chi_square(std::size_t dimension) {
  return chi_squared_quantile(0.5, static_cast<double>(dimension));
}

Pose pose_at(std::span<const double> path, std::size_t row) {
  return {path[3 * row], path[3 * row + 1], path[3 * row + 2]};
}

Pose between(const Pose& before, const Pose& after, double share) {
  const Eigen::Vector3d way = share * boxminus(after, before);
  return {before.x + way(0), before.y + way(1), wrap(before.heading + way(2))};
}

}  // namespace

PathAtFixes::PathAtFixes(const ReferencePath& reference, std::span<const double> times,
                         const Pose& start)
    : start_(start) {
  used_.name = reference.name;
  for (std::size_t f = 0; f < reference.time.size(); ++f) {
    const double time = reference.time[f];
    if (times.empty() || !(time >= 0.0 && time <= times.back())) continue;
    used_.time.push_back(time);
    used_.position.push_back(reference.position[f]);
    if (!reference.heading.empty()) used_.heading.push_back(reference.heading[f]);
    if (!reference.covariance.empty()) used_.covariance.push_back(reference.covariance[f]);
    places_.push_back(place_of(time, times));
  }
}

bool PathAtFixes::has_start() const {
  constexpr double kSame = 1e-6;  // [m]
  const Eigen::Vector2d start(start_.x, start_.y);
  return !used_.position.empty() && (used_.position.front() - start).norm() < kSame;
}

PathAtFixes::Place PathAtFixes::place_of(double time, std::span<const double> times) {
  const auto next = std::ranges::lower_bound(times, time);
  const double before = next == times.begin() ? 0.0 : *(next - 1);
  const double length = *next - before;
  return {static_cast<std::size_t>(next - times.begin()),
          length > 0.0 ? (time - before) / length : 1.0};
}

std::vector<Pose> PathAtFixes::interpolate(std::span<const double> path) const {
  std::vector<Pose> poses;
  poses.reserve(places_.size());
  for (const Place& place : places_) {
    const Pose before = place.next == 0 ? start_ : pose_at(path, place.next - 1);
    poses.push_back(between(before, pose_at(path, place.next), place.share));
  }
  return poses;
}

namespace {

using BeliefMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Covariance of the pose after a scan, as the filter reports it.
struct ScanBelief {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double inverse_freedom = 0.0;  ///< 1 / degrees of freedom of that covariance; 0: it is exact
  bool is_known = true;
};

/// Beliefs of all scans, and their means row by row.
struct ScanBeliefs {
  std::vector<double> mean;  ///< {scan, 3} [m, m, rad]
  std::vector<ScanBelief> beliefs;
};

/// Expected covariance of the mean's error for drawn poses, with Satterthwaite's degrees of freedom
/// (STATISTICS 4).
ScanBelief belief_of_draws(const Eigen::Matrix3d& spread, const EffectiveDraws& draws,
                           std::size_t dimension) {
  ScanBelief belief;
  belief.is_known = draws.of_mean > static_cast<double>(dimension) + 2.0;
  if (!belief.is_known) return belief;
  belief.covariance = spread * (draws.of_mean + 1.0) / (draws.of_mean - 1.0);
  belief.inverse_freedom = 1.0 / (draws.of_variance - 1.0);
  return belief;
}

ScanBeliefs beliefs_of(const RunRows& rows, std::size_t particles, std::size_t scans,
                       std::size_t dimension) {
  ScanBeliefs all;
  const bool has_mixture = !rows.mixture.covariance.empty();
  for (std::size_t s = 0; s < scans; ++s) {
    const bool by_draws = particles > 0 && !rows.spread.covariance.empty() && is_drawn(rows, s);
    const MomentRows& moments = !by_draws && has_mixture ? rows.mixture : rows.spread;
    const Eigen::Matrix3d covariance =
        Eigen::Map<const BeliefMatrix>(moments.covariance.data() + 9 * s);
    const auto mean = std::span(moments.mean).subspan(3 * s, 3);
    all.mean.insert(all.mean.end(), mean.begin(), mean.end());
    all.beliefs.push_back(by_draws
                              ? belief_of_draws(covariance, draws_at(rows, particles, s), dimension)
                              : ScanBelief{covariance});
  }
  return all;
}

/// At the start the pose is known exactly.
ScanBelief belief_between(const std::vector<ScanBelief>& scans, const PathAtFixes::Place& place) {
  const ScanBelief& after = scans[place.next];
  const ScanBelief before = place.next == 0 ? ScanBelief{.inverse_freedom = after.inverse_freedom}
                                            : scans[place.next - 1];
  return {(1.0 - place.share) * before.covariance + place.share * after.covariance,
          std::lerp(before.inverse_freedom, after.inverse_freedom, place.share),
          before.is_known && after.is_known};
}

/// Converts the NEES by `total` = P + R to the scale of the chi-square, with the degrees of freedom
/// of the sum of an estimated and an exact covariance (K. Krishnamoorthy, J. Yu 2004).
double on_chi_square_scale(double nees, const Eigen::MatrixXd& total, const Eigen::MatrixXd& own,
                           double inverse_freedom) {
  if (inverse_freedom == 0.0) return nees;
  const auto d = static_cast<double>(total.rows());
  const Eigen::MatrixXd share = total.llt().solve(own);
  const double of_one = (share * share).trace() + share.trace() * share.trace();
  const double freedom = (d + d * d) / (inverse_freedom * of_one);
  constexpr double kExactMean = 1e300;  // the covariance is already that of the mean's error
  return sampler_scale(static_cast<std::size_t>(total.rows()))(nees, {kExactMean, freedom + 1.0});
}

void add_whitened(const Eigen::VectorXd& error, VectorSeries& series) {
  series.resize(static_cast<std::size_t>(error.size()));
  for (Eigen::Index c = 0; c < error.size(); ++c) {
    series[static_cast<std::size_t>(c)].push_back(error(c));
  }
}

/// The error in units of P + R; nullopt if that is not positive definite.
std::optional<Eigen::VectorXd> in_units_of(const Eigen::VectorXd& error, const ScanBelief& belief,
                                           const Eigen::MatrixXd& own,
                                           const Eigen::MatrixXd& of_fix) {
  const Eigen::MatrixXd total = own + of_fix;
  const Eigen::LLT<Eigen::MatrixXd> factor(total);
  if (!belief.is_known || !total.allFinite() || !error.allFinite() ||
      factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  const Eigen::VectorXd whitened = factor.matrixL().solve(error);
  const double nees = whitened.squaredNorm();
  if (nees == 0.0) return whitened;
  const double scaled = on_chi_square_scale(nees, total, own, belief.inverse_freedom);
  return whitened * std::sqrt(scaled / nees);
}

bool is_stored(const RunRows& rows) {
  return !rows.spread.covariance.empty() || !rows.mixture.covariance.empty();
}

}  // namespace

FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const double> scan_times,
                          const RunRows& rows, std::size_t particles, ErrorBlock block) {
  FixErrors result;
  const bool needs_heading = block != ErrorBlock::position;
  if (!is_stored(rows) || (needs_heading && fixes.headings().empty())) return result;
  const std::size_t dimension = dimension_of(block);
  const Eigen::Index first = block == ErrorBlock::heading ? 2 : 0;
  const auto d = static_cast<Eigen::Index>(dimension);
  const ScanBeliefs scans = beliefs_of(rows, particles, scan_times.size(), dimension);
  const std::vector<Pose> poses = fixes.interpolate(scans.mean);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const PathAtFixes::Place& place = fixes.places()[f];
    const double before = place.next == 0 ? 0.0 : scan_times[place.next - 1];
    if (scan_times[place.next] - before > kLongestScanGap) {
      ++result.in_gaps;
      continue;
    }
    const double heading = fixes.headings().empty() ? poses[f].heading : fixes.headings()[f];
    const Eigen::Vector2d& position = fixes.positions()[f];
    const Eigen::Vector3d error = boxminus(poses[f], {position.x(), position.y(), heading});
    const ScanBelief belief = belief_between(scans.beliefs, place);
    const Eigen::MatrixXd of_fix = fixes.covariances()[f].block(first, first, d, d);
    const auto whitened = in_units_of(error.segment(first, d), belief,
                                      belief.covariance.block(first, first, d, d), of_fix);
    if (!whitened) {
      ++result.undefined;
      continue;
    }
    add_whitened(*whitened, result.whitened);
    add_whitened(of_fix.llt().matrixL().solve(error.segment(first, d)), result.by_reference);
    result.nees.push_back(whitened->squaredNorm());
    result.times.push_back(fixes.times()[f]);
  }
  return result;
}

namespace {

constexpr std::size_t kFewestFixes = 2;
constexpr double kSameWithin = 1e-3;  // [standard deviations of a fix]

/// Largest squared length of {component}{sample}.
double farthest_square(const VectorSeries& series) {
  double farthest = 0.0;
  for (std::size_t t = 0; t < series.front().size(); ++t) {
    double square = 0.0;
    for (const auto& component : series) square += component[t] * component[t];
    farthest = std::max(farthest, square);
  }
  return farthest;
}

void judge_leading(const FixErrors& errors, double level, DriveScores& scores) {
  scores.fixes = errors.nees.size();
  scores.in_gaps = errors.in_gaps;
  scores.undefined = errors.undefined;
  if (scores.fixes < kFewestFixes) return;
  scores.median = median_of(errors.nees) / median_of_chi_square(dimension_of(scores.leading));
  scores.seconds = errors.times.back() - errors.times.front();
  scores.is_the_reference = farthest_square(errors.by_reference) < kSameWithin * kSameWithin;
  scores.is_below_reference = correlated_average(errors.by_reference, level).ratio.upper < 1.0;
}

}  // namespace

DriveScores drive_scores(const PathAtFixes& fixes, std::span<const double> scan_times,
                         const RunRows& rows, std::size_t particles, double level) {
  DriveScores scores;
  scores.leading = fixes.headings().empty() ? ErrorBlock::position : ErrorBlock::pose;
  for (const ErrorBlock block : kErrorBlocks) {
    FixErrors errors = errors_at_fixes(fixes, scan_times, rows, particles, block);
    if (block == scores.leading) judge_leading(errors, level, scores);
    if (errors.nees.size() < kFewestFixes) continue;
    scores.blocks[static_cast<std::size_t>(block)] = correlated_average(errors.whitened, level);
    scores.errors[static_cast<std::size_t>(block)] = std::move(errors.whitened);
  }
  return scores;
}

namespace {

/// So few effective samples may as well be one that lasts for the whole drive.
constexpr double kFewestEffective = 3.0;

/// Means over runs; each run by itself has an interval that holds, and the runs are not
/// independent.
CorrelatedAverage mean_over_drives(std::span<const DriveScores> runs, std::size_t block) {
  const auto is_judged = [&](const DriveScores& run) {
    return run.blocks[block].effective_samples > 0.0;
  };
  const auto n = static_cast<double>(std::ranges::count_if(runs, is_judged));
  CorrelatedAverage mean;
  if (n == 0.0) return mean;
  double inverse = 0.0;
  for (const DriveScores& run : runs) {
    if (!is_judged(run)) continue;
    const CorrelatedAverage& one = run.blocks[block];
    mean.mean += one.mean / n;
    mean.ratio.lower += one.ratio.lower / n;
    mean.ratio.upper += one.ratio.upper / n;
    inverse += 1.0 / one.effective_samples / n;
  }
  mean.effective_samples = 1.0 / inverse;
  return mean;
}

DriveScores mean_scores(std::span<const DriveScores> runs) {
  DriveScores all = runs.front();
  all.median = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = mean_over_drives(runs, block);
  }
  for (const DriveScores& run : runs) {
    all.median += run.median / static_cast<double>(runs.size());
    all.in_gaps = std::max(all.in_gaps, run.in_gaps);
    all.undefined = std::max(all.undefined, run.undefined);
    all.fixes = std::min(all.fixes, run.fixes);
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  return all;
}

Answer answer_of_drive(const Interval& ratio, double within) {
  if (ratio.lower >= 1.0 / within && ratio.upper <= within) return Answer::consistent;
  if (ratio.lower > 1.0) return Answer::optimistic;
  return ratio.upper < 1.0 ? Answer::conservative : Answer::undecided;
}

/// The average over the runs that have the block.
CorrelatedAverage over_own_drives(std::span<const DriveScores> runs, std::size_t block,
                                  double level) {
  std::vector<VectorSeries> drives;
  for (const DriveScores& run : runs) {
    if (run.blocks[block].effective_samples > 0.0) drives.push_back(run.errors[block]);
  }
  return drives.empty() ? CorrelatedAverage{} : correlated_average(drives, level);
}

DriveScores sums_over_drives(std::span<const DriveScores> runs, double level) {
  DriveScores all;
  all.leading = runs.front().leading;
  all.median = 0.0;
  double judged = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = over_own_drives(runs, block, level);
  }
  for (const DriveScores& run : runs) {
    all.in_gaps += run.in_gaps;
    all.undefined += run.undefined;
    if (!(run.leads().effective_samples > 0.0)) continue;
    judged += 1.0;
    all.median += run.median;
    all.fixes += run.fixes;
    all.seconds += run.seconds;
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  all.median /= judged;
  return all;
}

/// Fills verdict and minutes from the mean.
void decide(double level, DriveConsistency& result) {
  const CorrelatedAverage& leads = result.mean.leads();
  if (!(leads.effective_samples > 0.0) || result.mean.is_the_reference) return;
  result.answer = answer_of_drive(leads.ratio, result.within);
  result.minutes = result.mean.seconds / 60.0 *
                   samples_that_decide(dimension_of(result.mean.leading), level, result.within) /
                   leads.effective_samples;
}

std::string drives_text(const DriveConsistency& found) {
  const std::string these = found.drives == 1
                                ? "one judged drive cannot tell"
                                : std::to_string(found.drives) + " drives cannot tell";
  const double needed =
      static_cast<double>(found.drives) * found.minutes * 60.0 / found.mean.seconds;
  if (!std::isfinite(needed)) return these + ", nor could more";
  return these + ": it would take " + compact(std::ceil(needed)) + " like them";
}

std::string minutes_text(const DriveConsistency& drive) {
  if (drive.drives > 0) return drives_text(drive);
  if (std::isinf(drive.minutes)) return "this drive cannot tell, nor could a longer one";
  const bool is_least = drive.mean.leads().effective_samples < kFewestEffective;
  return std::string("this drive cannot tell: it would need ") + (is_least ? "at least " : "") +
         compact(std::max(drive.minutes, 1.0)) + " minutes";
}

/// "1.2 to 1.4", "more than 1.2"
std::string factor_words(double lower, double upper) {
  if (std::isinf(upper)) return "more than " + compact(lower);
  return compact(lower) + " to " + compact(upper);
}

}  // namespace

DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  if (runs.empty()) return result;
  result.mean = mean_scores(runs);
  decide(level, result);
  return result;
}

DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  result.drives = static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const DriveScores& run) { return run.leads().effective_samples > 0.0; }));
  if (runs.empty()) return result;
  result.mean = sums_over_drives(runs, level);
  decide(level, result);
  return result;
}

std::string in_words(const DriveConsistency& drive) {
  const Interval& ratio = drive.mean.leads().ratio;
  switch (drive.answer) {
    case Answer::consistent:
      return "consistent within " + exact_text(drive.within);
    case Answer::optimistic:
      return "optimistic: NEES " + factor_words(ratio.lower, ratio.upper) + " times too large";
    case Answer::conservative:
      return "conservative: NEES " + factor_words(1.0 / ratio.upper, 1.0 / ratio.lower) +
             " times too small";
    case Answer::undecided:
      return minutes_text(drive);
    case Answer::inconsistent:
    case Answer::untested:
      break;
  }
  return drive.mean.is_the_reference ? "refused: the reference is this estimate" : "not tested";
}

namespace {

/// {reference with known errors}
using DriveConsistencies = std::vector<DriveConsistency>;

class DrivesOverRuns final : public MergedSums<DrivesOverRuns> {
 public:
  explicit DrivesOverRuns(const RunCriteria& criteria)
      : level_(criteria.level),
        within_(criteria.within),
        are_own_(!criteria.drives.empty()),
        runs_(criteria.judged_fixes.size()) {}
  void add(const MeasuredRun& run) override {
    for (std::size_t r = 0; r < runs_.size(); ++r) runs_[r].push_back(run.drives[r]);
  }
  void put(CellAnalysis& cell) override {
    DriveConsistencies all;
    for (const auto& runs : runs_) {
      all.push_back(are_own_ ? judge_own_drives(runs, level_, within_)
                             : judge_drive(runs, level_, within_));
    }
    if (!all.empty()) cell.findings.put(all);
  }
  static constexpr auto parts() { return std::tuple(appended(&DrivesOverRuns::runs_)); }

 private:
  double level_, within_;
  bool are_own_;
  std::vector<std::vector<DriveScores>> runs_;  ///< {reference}{run}
};

/// Calls visit(cell, reference, its DriveConsistency).
template <class Visit>
void for_each_drive(const StudyAnalysis& study, const Visit& visit) {
  for (const CellAnalysis& cell : study.cells) {
    std::size_t k = 0;
    for (const JudgedReference& reference : study.references) {
      if (!reference.has_errors) continue;
      const DriveConsistencies& all = cell.get<DriveConsistencies>();
      if (k < all.size()) visit(cell, reference, all[k]);
      ++k;
    }
  }
}

std::string block_text(const DriveConsistency& drive, ErrorBlock block) {
  const CorrelatedAverage& found = drive.mean.blocks[static_cast<std::size_t>(block)];
  if (!(found.effective_samples > 0.0)) return "-";
  // The ends lie at very different distances: each is to be read by itself.
  return readable(found.mean) + " [" + compact(found.ratio.lower) + ", " +
         compact(found.ratio.upper) + "]";
}

std::vector<TextTable::Entry> drive_row(const CellAnalysis& cell, const JudgedReference& reference,
                                        const DriveConsistency& drive, const std::string& level) {
  const Innovations* innovations = cell.find<Innovations>();
  const bool is_judged = drive.answer != Answer::untested;
  const auto judged = [&](const std::string& text) { return is_judged ? text : "-"; };
  return {{"cell", cell.label, Align::left},
          {"reference", reference.name, Align::left},
          {"runs", runs_in_words(cell), Align::left},
          {"verdict", in_words(drive), Align::left},
          {"NEES / expected" + level, judged(block_text(drive, drive.mean.leading))},
          {"median / expected", judged(readable(drive.mean.median))},
          {"position" + level, judged(block_text(drive, ErrorBlock::position))},
          {"heading" + level, judged(block_text(drive, ErrorBlock::heading))},
          {"fixes", std::to_string(drive.mean.fixes)},
          {"effective", judged(readable(drive.mean.leads().effective_samples))},
          {"NIS per component", innovations == nullptr ? "-" : readable(innovations->ratio)},
          {"innovations", innovations == nullptr ? "-" : whiteness_in_words(*innovations),
           Align::left}};
}

TextTable drive_table(const StudyAnalysis& study) {
  const std::string level = " [" + level_text(study.level) + "]";
  TextTable table{.keys = 2};
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    table.add(drive_row(cell, reference, drive, level));
  });
  return table;
}

std::vector<std::string> warnings_of(const CellAnalysis& cell, const JudgedReference& reference,
                                     const DriveConsistency& drive) {
  std::vector<std::string> warnings;
  const auto add = [&](bool applies, const char* key, const Values& values = {}) {
    if (applies) warnings.push_back(prose("drive", key, values));
  };
  const auto count = [](std::size_t n) { return std::to_string(n); };
  add(drive.mean.is_below_reference, "below reference");
  add(reference.has_start, "starts at fix");
  add(cell.filter == "external", "external");
  add(drive.mean.in_gaps > 0, "in gaps",
      {{"fixes", count(drive.mean.in_gaps)}, {"gap", readable(kLongestScanGap, 1)}});
  add(drive.mean.undefined > 0, "undefined", {{"fixes", count(drive.mean.undefined)}});
  return warnings;
}

TextTable warning_table(const StudyAnalysis& study) {
  TextTable table;
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    for (const std::string& warning : warnings_of(cell, reference, drive)) {
      table.add({{"cell", cell.label, Align::left},
                 {"reference", reference.name, Align::left},
                 {"to be considered", warning, Align::left}});
    }
  });
  return table;
}

std::vector<Section> drive_sections(const StudyAnalysis& study) {
  Section section = section_of("drive");
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    section.blocks.emplace_back(
        Section::Lead{cell.label + " by " + reference.name + ": " + in_words(drive) + "."});
  });
  section.add("drive", drive_table(study));
  if (section.blocks.empty()) return {};
  section.add("drive_warnings", warning_table(study));
  section.add_notes(
      "notes",
      {{"independence", prose("drive", study.own_drives == 0 ? "same drive" : "own drives")}});
  return {section};
}

Frame::Row drive_numbers(const DriveConsistency& drive) {
  const DriveScores& mean = drive.mean;
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  Frame::Row all = {{"within", "1", drive.within},
                    {"fixes", "1", count(mean.fixes)},
                    {"fixes_in_gaps", "1", count(mean.in_gaps)},
                    {"fixes_undefined", "1", count(mean.undefined)},
                    {"median_nees_ratio", "1", mean.median},
                    {"needed", "min", drive.minutes},
                    {"drives", "1", count(drive.drives)}};
  static const std::vector<ResultNumber<CorrelatedAverage>> kBlockNumbers = {
      {"nees_ratio", "1", &CorrelatedAverage::mean, {}, {}, &CorrelatedAverage::ratio},
      {"effective_fixes", "1", &CorrelatedAverage::effective_samples}};
  for (const ErrorBlock block : kErrorBlocks) {
    const CorrelatedAverage& found = mean.blocks[static_cast<std::size_t>(block)];
    Frame::Row row;
    add_numbers(kBlockNumbers, found.effective_samples > 0.0 ? &found : nullptr, row);
    for (Frame::Entry& entry : row) entry.name = name_of(block) + "_" + entry.name;
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

Frame drive_frame(const StudyAnalysis& study) {
  Frame frame;
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    frame.add({{"cell", cell.label},
               {"filter", cell.filter},
               {"reference", reference.name},
               {"verdict", in_words(drive)}},
              drive_numbers(drive));
  });
  return frame;
}

}  // namespace

Metric drive_metric() {
  return {.sums = make_sums<DrivesOverRuns>,
          .sections = drive_sections,
          .files = {{"drive.csv", drive_frame}}};
}

}  // namespace montecarta::analysis
