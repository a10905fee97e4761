// SPDX-License-Identifier: BSD-3-Clause
// Why a cell is inconsistent: bias or scatter, in which direction, how far.
#include "analysis/metrics/error_anatomy.hpp"

#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kFewestRunsOfMoments = 4.0;
constexpr std::size_t kDraws = 2000;

/// One scan's moments over runs.
struct Moment {
  Eigen::Vector3d bias;
  Eigen::Matrix3d squares;     ///< mean squared error
  Eigen::Matrix3d covariance;  ///< believed
  double n;
};

double bias_share(const Moment& m) {
  const Eigen::LLT<Eigen::Matrix3d> P(m.covariance);
  const double nees = P.solve(m.squares).trace();
  const double by_bias = m.bias.dot(P.solve(m.bias));
  const double by_chance = (nees - by_bias) / (m.n - 1.0);  // of a mean over n errors without bias
  return std::clamp((by_bias - by_chance) / nees, 0.0, 1.0);
}

struct Worst {
  double ratio;
  Eigen::Vector3d shares;
};

Worst worst_of(const Moment& m) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.squares, m.covariance);
  const Eigen::Vector3d weights =
      solver.eigenvectors().col(2).cwiseProduct(m.covariance.diagonal().cwiseSqrt());
  return {solver.eigenvalues()(2), weights.cwiseAbs2() / weights.squaredNorm()};
}

/// Adds up what is averaged over scans.
class OverScans {
 public:
  void add(double share, const Worst& worst) {
    share_ += share;
    logarithm_ += std::log(worst.ratio);
    direction_ += worst.shares;
    n_ += 1.0;
  }
  void put(ErrorAnatomy& anatomy) const {
    anatomy.mean_bias_share = share_ / n_;
    anatomy.mean_worst_ratio = std::exp(logarithm_ / n_);
    for (int c = 0; c < 3; ++c)
      anatomy.worst_direction[static_cast<std::size_t>(c)] = direction_(c) / n_;
  }

 private:
  double share_ = 0.0, logarithm_ = 0.0, n_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
};

}  // namespace

// Bartlett's decomposition: n times the mean squared error of whitened errors is T T', T lower
// triangular of normals below roots of chi-squares.
double expected_worst_ratio(std::size_t runs, double level) {
  if (runs < 3) return std::numeric_limits<double>::infinity();
  const auto n = static_cast<double>(runs);
  std::vector<double> ratios;
  for (std::size_t k = 0; k < kDraws; ++k) {
    RngStream draw(
        {.seed = 1, .run = k, .step = 0, .index = 0, .purpose = Draw::analysis_bootstrap});
    Eigen::Matrix3d T = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      T(i, i) = std::sqrt(boost::math::quantile(boost::math::chi_squared(n - i), draw.uniform()));
      for (int j = 0; j < i; ++j) T(i, j) = draw.normal();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(T * T.transpose() / n,
                                                                Eigen::EigenvaluesOnly);
    ratios.push_back(solver.eigenvalues()(2));
  }
  const auto nth = ratios.begin() + static_cast<std::ptrdiff_t>(level * (kDraws - 1));
  std::ranges::nth_element(ratios, nth);
  return *nth;
}

void ErrorMoments::add(std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (!errors[s].allFinite() || !covariances[s].allFinite()) continue;
    scans_[s].n += 1.0;
    scans_[s].error += errors[s];
    scans_[s].squares += errors[s] * errors[s].transpose();
    scans_[s].covariance += covariances[s];
  }
}

ErrorAnatomy ErrorMoments::result() const {
  ErrorAnatomy anatomy;
  OverScans over_scans;
  for (const Sums& sums : scans_) {
    const Moment m{sums.error / sums.n, sums.squares / sums.n, sums.covariance / sums.n, sums.n};
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      anatomy.happened[component].push_back(std::sqrt(m.squares(c, c)));
      anatomy.believed[component].push_back(std::sqrt(m.covariance(c, c)));
      anatomy.bias[component].push_back(m.bias(c));
    }
    const bool known = m.n >= kFewestRunsOfMoments &&
                       Eigen::LLT<Eigen::Matrix3d>(m.covariance).info() == Eigen::Success;
    const Worst worst = known ? worst_of(m) : Worst{kNaN, {}};
    anatomy.bias_share.push_back(known ? bias_share(m) : kNaN);
    anatomy.worst_ratio.push_back(worst.ratio);
    if (known && worst.ratio > 0.0) over_scans.add(anatomy.bias_share.back(), worst);
  }
  over_scans.put(anatomy);
  return anatomy;
}

namespace {

class ErrorAnatomyOverRuns final : public MetricSums {
 public:
  explicit ErrorAnatomyOverRuns(const RunCriteria& criteria) : moments_(criteria.times.size()) {}
  void add(const MeasuredRun& run) override {
    const RunMetrics& metrics = run.metrics;
    if (metrics.covariances().empty()) return;
    is_empty_ = false;
    moments_.add(metrics.errors(), metrics.covariances());
  }
  void put(CellAnalysis& cell) override {
    if (is_empty_) return;
    cell.findings.put(moments_.result());
  }

 private:
  bool is_empty_ = true;
  ErrorMoments moments_;
};

void error_anatomy_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const bool known = cell.find<ErrorAnatomy>() != nullptr;
  const ErrorAnatomy& anatomy = cell.get<ErrorAnatomy>();
  all.push_back({"worst_variance_ratio", "1", known ? anatomy.mean_worst_ratio : kNaN});
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    all.push_back({std::string("worst_direction_") + kErrorComponents[c], "1",
                   known ? anatomy.worst_direction[c] : kNaN});
  }
  all.push_back({"bias_share", "1", known ? anatomy.mean_bias_share : kNaN});
}

void error_anatomy_series(const CellAnalysis& cell, std::vector<NamedSeries>& all) {
  const ErrorAnatomy* anatomy = cell.find<ErrorAnatomy>();
  if (anatomy == nullptr) return;
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    const std::string name = kErrorComponents[c];
    const std::string units = name == "heading" ? "rad" : "m";
    all.push_back({"rms_error_" + name, units, anatomy->happened[c]});
    all.push_back({"believed_deviation_" + name, units, anatomy->believed[c]});
    all.push_back({"mean_error_" + name, units, anatomy->bias[c]});
  }
  all.push_back({"bias_share", "1", anatomy->bias_share});
  all.push_back({"worst_variance_ratio", "1", anatomy->worst_ratio});
}

/// "heading 97 %".
std::string direction_text(const ErrorAnatomy& anatomy) {
  const auto& shares = anatomy.worst_direction;
  const auto most = std::ranges::max_element(shares);
  if (std::isnan(*most)) return "-";
  return std::string(kErrorComponents[static_cast<std::size_t>(most - shares.begin())]) + " " +
         readable(100.0 * *most, 2) + " %";
}

std::vector<std::string> why_row(const CellAnalysis& cell, double level) {
  const ErrorAnatomy& anatomy = *cell.find<ErrorAnatomy>();
  const double share = cell.get<LineageSummary>().monte_carlo_share;
  return {cell.label,
          readable(anatomy.mean_worst_ratio),
          readable(expected_worst_ratio(cell.complete, level)),
          direction_text(anatomy),
          percent(anatomy.mean_bias_share),
          std::isfinite(share) ? percent(share) : "-"};
}

TextTable why_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"worst variance ratio"},
                    {"expected below"},
                    {"worst direction"},
                    {"bias"},
                    {"Monte Carlo share"}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.find<ErrorAnatomy>()) table.rows.push_back(why_row(cell, study.level));
  }
  return table;
}

std::vector<std::string> why_notes(const StudyAnalysis& study) {
  return {
      "The worst variance ratio is how many times larger the squared errors are than the filter's "
      "variance, in the direction where that is worst (seen from the true vehicle: forward, left, "
      "heading), geometric mean over scans; of a consistent filter it is below 'expected below' "
      "at " +
          level_text(study.level) +
          " of scans. The direction says which component that is, in units of its deviation.",
      "'bias' is the part of ANEES that the mean error makes: what is left is scatter that the "
      "filter does not know of. Bias calls for a better model, scatter for a noise model that "
      "matches.",
      "'Monte Carlo share' is the part of the squared position error that comes from the particles "
      "being few, by how far their families differ; it needs record.columns with ancestry and "
      "particles."};
}

/// Where the worst ratio of a consistent filter lies, by the cell with the fewest runs.
Band expected_ratios(const StudyAnalysis& study) {
  std::size_t fewest = study.runs_here;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.find<ErrorAnatomy>()) fewest = std::min(fewest, cell.complete);
  }
  return {"consistent filter", 1.0, expected_worst_ratio(fewest, study.level)};
}

Figure why_figure(const StudyAnalysis& study) {
  Figure figure{"why", "What is wrong, scatter or bias?", ""};
  figure.sentence =
      "Above: how many times larger squared errors are than the variance the filter believes, in "
      "the direction where that is worst. Below: how much of ANEES comes from errors that all runs "
      "share (bias); the rest is scatter that the filter does not know of.";
  const CellValues ratio = [](const CellAnalysis& cell) {
    return cell.get<ErrorAnatomy>().worst_ratio;
  };
  const CellValues bias = [](const CellAnalysis& cell) {
    return scaled(cell.get<ErrorAnatomy>().bias_share, 100.0);
  };
  std::vector<Panel> panels = cell_panels(
      study, {"worst_variance_ratio", "worst variance ratio", {}, {}, Scale::automatic}, ratio);
  for (Panel& panel : panels) panel.bands.push_back(expected_ratios(study));
  for (Panel& panel :
       cell_panels(study, {"bias_share", "bias in ANEES [%]", {}, {}, Scale::percent}, bias)) {
    panels.push_back(std::move(panel));
  }
  add_panels(panels, study.times, figure);
  return figure;
}

std::vector<Section> error_anatomy_sections(const StudyAnalysis& study) {
  const TextTable table = why_table(study);
  if (table.rows.empty()) return {};
  Section section{"error_anatomy", "Why?"};
  section.add("why", table);
  section.add(why_notes(study));
  return {section};
}

std::vector<Figure> error_anatomy_figures(const StudyAnalysis& study) {
  return {why_figure(study)};
}

}  // namespace

Metric error_anatomy_metric() {
  return {.sums = make_sums<ErrorAnatomyOverRuns>,
          .add_numbers = error_anatomy_numbers,
          .add_series = error_anatomy_series,
          .sections = error_anatomy_sections,
          .figures = error_anatomy_figures};
}

}  // namespace montecarta::analysis
