// SPDX-License-Identifier: BSD-3-Clause
// Pose and map together.
#include "analysis/metrics/joint_nees.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/figure.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace montecarta::analysis {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// e' P^-1 e by Cholesky of the correlation matrix, whose pivots do not depend on units.
double quadratic_form(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!error.allFinite() || !covariance.allFinite() || !scale.allFinite()) return kNaN;
  const Eigen::LLT<Eigen::MatrixXd> L(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (L.info() != Eigen::Success) return kNaN;
  return L.matrixL().solve(scale.cwiseProduct(error)).squaredNorm();
}

/// Of the pose and of each landmark: where the truth is known and the map has one.
Eigen::VectorXd error_of(std::span<const double> mean, std::span<const double> pose,
                         std::span<const Eigen::Vector2d> landmarks,
                         std::vector<Eigen::Index>& rows) {
  Eigen::VectorXd error(static_cast<Eigen::Index>(mean.size()));
  rows = {0, 1, 2};
  error.head<3>() << mean[0] - pose[0], mean[1] - pose[1], wrap(mean[2] - pose[2]);
  for (std::size_t l = 0; l < landmarks.size() && 4 + 2 * l < mean.size(); ++l) {
    const auto row = static_cast<Eigen::Index>(3 + 2 * l);
    const bool in_map = !std::isnan(mean[3 + 2 * l]);
    error.segment<2>(row) = Eigen::Vector2d(mean[3 + 2 * l], mean[4 + 2 * l]) - landmarks[l];
    if (in_map) rows.insert(rows.end(), {row, row + 1});
  }
  return error;
}

Interval bounds_per_component(double dimensions, double level) {
  const Interval sum = nees_bounds(1, static_cast<std::uint64_t>(dimensions), level);
  return {sum.lower / dimensions, sum.upper / dimensions};
}

/// Consistent where every row is shown to be within the margin, else rejected where one is shown to
/// be off; too large goes before too small.
void judge_rows(JointConsistency& found) {
  bool is_within = true;
  double highest = 1.0, lowest = 1.0;
  for (std::size_t k = 0; k < found.average.size(); ++k) {
    if (found.runs[k] == 0) continue;
    const Interval ratio = ratio_of_row(found, k);
    found.verdict = Verdict::undecided;
    is_within = is_within && ratio.upper <= found.within && ratio.lower * found.within >= 1.0;
    if (ratio.lower > highest) {
      highest = ratio.lower;
      found.highest_row = k;
    }
    if (ratio.upper < lowest) {
      lowest = ratio.upper;
      found.lowest_row = k;
    }
  }
  if (found.verdict == Verdict::untested) return;
  found.verdict = is_within           ? Verdict::consistent
                  : found.highest_row ? Verdict::optimistic
                  : found.lowest_row  ? Verdict::conservative
                                      : Verdict::undecided;
}

/// Runs after which the interval of no row is longer, in logarithms, than the margin, so that it
/// excludes 1 or is inside.
std::uint64_t more_runs_that_decide(const JointConsistency& found, double row_level) {
  std::uint64_t more = 1;
  for (std::size_t k = 0; k < found.average.size(); ++k) {
    const auto runs = static_cast<std::uint64_t>(found.runs[k]);
    if (runs == 0) continue;
    const auto decide = [&](std::uint64_t n) {
      const Interval bounds =
          bounds_per_component(static_cast<double>(n) * found.dimension[k], row_level);
      return bounds.upper <= found.within * bounds.lower;
    };
    std::uint64_t enough = runs, too_few = runs;
    while (!decide(enough)) enough *= 2;
    while (enough - too_few > 1) {
      const std::uint64_t middle = too_few + (enough - too_few) / 2;
      (decide(middle) ? enough : too_few) = middle;
    }
    more = std::max(more, enough - runs);
  }
  return more;
}

}  // namespace

Interval ratio_of_row(const JointConsistency& joint, std::size_t row) {
  return {joint.average[row] / joint.bounds[row].upper,
          joint.average[row] / joint.bounds[row].lower};
}

std::vector<JointScore> joint_scores(const JointRows& rows, std::span<const std::uint32_t> scans,
                                     std::span<const double> truth,
                                     std::span<const Eigen::Vector2d> landmarks) {
  std::vector<JointScore> scores;
  std::vector<Eigen::Index> known;
  const std::size_t states = rows.states();
  if (states == 0) return scores;
  for (std::size_t k = 0; k * states < rows.mean.size(); ++k) {
    const auto mean = std::span(rows.mean).subspan(k * states, states);
    const Eigen::VectorXd error =
        error_of(mean, truth.subspan(3 * std::size_t{scans[k]}, 3), landmarks, known);
    const auto size = static_cast<Eigen::Index>(states);
    const Eigen::Map<const RowMajor> P(rows.covariance.data() + k * states * states, size, size);
    scores.push_back({quadratic_form(error(known), P(known, known)), known.size()});
  }
  return scores;
}

double nees_per_component(std::span<const JointScore> scores) {
  double sum = 0.0, dimensions = 0.0;
  for (const JointScore& score : scores) {
    if (std::isnan(score.nees)) continue;
    sum += score.nees;
    dimensions += static_cast<double>(score.dimension);
  }
  return sum / dimensions;
}

void JointNeesSums::add(std::span<const JointScore> run) {
  if (run.empty()) return;
  ++n_runs_;
  rows_.resize(run.size());
  for (std::size_t k = 0; k < run.size(); ++k) {
    const auto dimension = static_cast<double>(run[k].dimension);
    rows_[k].all_dimensions += dimension;
    if (std::isnan(run[k].nees)) continue;
    rows_[k].nees += run[k].nees;
    rows_[k].dimensions += dimension;
    ++rows_[k].runs;
  }
}

/// The sum over runs is chi-square with the sum of the dimensions; each of K rows is tested at
/// 1 - (1 - level) / K, so that a consistent filter passes all with probability `level` at least.
JointConsistency JointNeesSums::result(double level, bool identities_known, double within) const {
  JointConsistency found;
  found.within = within;
  found.stored = n_runs_ > 0;
  if (!found.stored) return found;
  if (!identities_known) {
    found.missing = "nobody knows which landmark is which";
    return found;
  }
  const double row_level = 1.0 - (1.0 - level) / static_cast<double>(rows_.size());
  for (const Sums& row : rows_) {
    found.samples += n_runs_;
    found.undefined += n_runs_ - row.runs;
    found.runs.push_back(row.runs);
    found.dimension.push_back(row.all_dimensions / static_cast<double>(n_runs_));
    found.average.push_back(row.nees / row.dimensions);
    if (row.runs == 0) {
      found.bounds.push_back({kNaN, kNaN});
      continue;
    }
    found.bounds.push_back(bounds_per_component(row.dimensions, row_level));
  }
  judge_rows(found);
  if (found.verdict == Verdict::undecided) {
    found.more_runs = more_runs_that_decide(found, row_level);
  }
  return found;
}

namespace {

constexpr Score kJointNeesScores[] = {
    {"joint_nees", "1", "joint NEES of pose and map per component",
     [](const MeasuredRun& run) {
       return run.has_identities ? nees_per_component(run.joint) : kNaN;
     },
     Better::neither}};

class JointNeesOverRuns final : public MetricSums {
 public:
  explicit JointNeesOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override { joint_.add(run.joint); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(joint_.result(criteria_->verdict_level(), criteria_->map.identities_known,
                                    criteria_->within));
  }

 private:
  const RunCriteria* criteria_;
  JointNeesSums joint_;
};

/// At the last stored scan.
void joint_nees_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const bool known = joint.verdict != Verdict::untested;
  const Interval bounds = known ? joint.bounds.back() : Interval{kNaN, kNaN};
  all.push_back({"joint_components", "1", known ? joint.dimension.back() : kNaN});
  all.push_back({"joint_nees_per_component", "1", known ? joint.average.back() : kNaN});
  all.push_back({"joint_nees_lower", "1", bounds.lower});
  all.push_back({"joint_nees_upper", "1", bounds.upper});
  all.push_back({"joint_undefined", "1", static_cast<double>(joint.undefined)});
}

bool is_judged(const CellAnalysis& cell) {
  return cell.get<JointConsistency>().verdict != Verdict::untested;
}

std::string words_of(const JointConsistency& joint, const std::vector<double>& times) {
  Consistency found;
  found.verdict = joint.verdict;
  found.within = joint.within;
  if (const auto row = joint.highest_row) found.highest = {ratio_of_row(joint, *row), times[*row]};
  if (const auto row = joint.lowest_row) found.lowest = {ratio_of_row(joint, *row), times[*row]};
  found.more_runs = joint.more_runs;
  return in_words(found);
}

/// The stored scan at which the average is farthest from 1.
std::size_t worst_row(const JointConsistency& joint) {
  const auto distance = [](double average) {
    return std::isnan(average) ? -1.0 : std::abs(std::log(average));
  };
  return static_cast<std::size_t>(std::ranges::max_element(joint.average, {}, distance) -
                                  joint.average.begin());
}

std::vector<std::string> row_of(const CellAnalysis& cell, const std::vector<double>& times) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const std::size_t worst = worst_row(joint);
  return {cell.label,
          readable(joint.dimension.back()),
          readable(joint.average.back()),
          interval_text(joint.bounds.back()),
          readable(joint.average[worst]) + " at " + readable(times[worst]) + " s",
          words_of(joint, times)};
}

/// Whether any cell was judged by its joint estimates.
bool has_joint_nees(const StudyAnalysis& study) {
  return std::ranges::any_of(study.cells, is_judged);
}

/// One row a cell that has joint estimates: is it consistent in pose and map together? Without rows
/// where none has.
TextTable joint_table(const StudyAnalysis& study) {
  TextTable table;
  if (!has_joint_nees(study)) return table;
  table.headings = {{"cell", Align::left}, {"components at the end"}, {"NEES / component"},
                    {"expected within"},   {"farthest from 1"},       {"pose and map"}};
  for (const CellAnalysis& cell : study.cells) {
    if (is_judged(cell)) table.rows.push_back(row_of(cell, study.joint_times));
  }
  return table;
}

/// How to read it, a sentence each, or why there are no numbers; nothing where none are stored.
std::vector<std::string> joint_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (has_joint_nees(study)) {
    notes.push_back(
        "Pose and map together: the squared error of the vehicle and of all landmarks at once, "
        "measured by the covariance that the filter has of them all, for each component (1 is "
        "expected, more is overconfident). It also sees wrong correlations, which no part by "
        "itself shows. It is consistent where the average of every stored scan is shown to be "
        "within the margin. 'Expected within' is where a consistent filter stays at all " +
        std::to_string(study.joint_times.size()) + " stored scans with a probability of " +
        percent(study.level) + " at least.");
  }
  for (const CellAnalysis& cell : study.cells) {
    const JointConsistency& joint = cell.get<JointConsistency>();
    if (!joint.missing.empty()) {
      notes.push_back(cell.label + ": pose and map together are not judged, since " +
                      joint.missing + ".");
    } else if (joint.undefined > 0) {
      notes.push_back(cell.label + ": of " + std::to_string(joint.samples) + " joint covariances " +
                      std::to_string(joint.undefined) +
                      " were not a number or not positive definite (left out of the average).");
    }
  }
  return notes;
}

/// One row a cell and stored scan: joint NEES per component with its bounds.
void write_joint_nees(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged(cell)) continue;
    const JointConsistency& joint = cell.get<JointConsistency>();
    for (std::size_t k = 0; k < joint.average.size(); ++k) {
      file.row({{"cell", cell.label}}, {{"time", "s", study.joint_times[k]},
                                        {"runs", "1", static_cast<double>(joint.runs[k])},
                                        {"components", "1", joint.dimension[k]},
                                        {"nees_per_component", "1", joint.average[k]},
                                        {"lower", "1", joint.bounds[k].lower},
                                        {"upper", "1", joint.bounds[k].upper}});
    }
  }
  file.close();
}

/// The ends of the band, which is the narrower the larger the map is; one band for each number of
/// runs that it is for.
void add_band(const CellAnalysis& cell, double level, bool is_first, Panel& panel) {
  std::vector<double> lower, upper;
  for (const Interval& bounds : cell.get<JointConsistency>().bounds) {
    lower.push_back(bounds.lower);
    upper.push_back(bounds.upper);
  }
  panel.curves.push_back(
      {is_first ? level_text(level) + " band" : "", kReferenceStyle, std::move(lower)});
  panel.curves.push_back({"", kReferenceStyle, std::move(upper)});
}

/// NEES of pose and map together at the scans at which joint estimates are stored, with the band of
/// a consistent filter. Without data where no cell was judged by them.
Figure joint_figure(const StudyAnalysis& study) {
  Figure figure{"joint_nees", "Is the filter right about pose and map together?", ""};
  figure.sentence =
      "Normalised error squared of the vehicle and all landmarks at once, for each component: 1 is "
      "right, and a curve between the dashed lines at every stored scan belongs to a filter whose "
      "covariance, with all its correlations, fits its errors. It finds fault with a filter sooner "
      "than the pose alone, since every landmark is a witness.";
  Panel panel{"joint_nees", "joint NEES per component", {}, {}, Scale::automatic};
  std::set<std::vector<std::uint32_t>> runs;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    const CellAnalysis& cell = study.cells[i];
    if (cell.get<JointConsistency>().verdict == Verdict::untested) continue;
    panel.curves.push_back({cell.label, i, cell.get<JointConsistency>().average});
    if (runs.insert(cell.get<JointConsistency>().runs).second)
      add_band(cell, study.level, runs.size() == 1, panel);
  }
  add_panels({panel}, study.joint_times, figure);
  return figure;
}

std::vector<Section> joint_nees_sections(const StudyAnalysis& study) {
  Section section{"joint_nees", "Pose and map together"};
  section.add("joint_nees", joint_table(study));
  section.add(joint_notes(study));
  return {section};
}

std::vector<Figure> joint_nees_figures(const StudyAnalysis& study) { return {joint_figure(study)}; }

}  // namespace

Metric joint_nees_metric() {
  return {.scores = kJointNeesScores,
          .scores_are_numbers = false,
          .sums = make_sums<JointNeesOverRuns>,
          .add_numbers = joint_nees_numbers,
          .sections = joint_nees_sections,
          .figures = joint_nees_figures,
          .files = {{"joint_nees.csv", has_joint_nees, write_joint_nees}}};
}

}  // namespace montecarta::analysis
