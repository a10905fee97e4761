// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"

namespace montecarta::analysis {
namespace {

std::string anees_note(const StudyAnalysis& study, const std::string& level) {
  const std::string dimension = std::to_string(study.imported.components.size());
  return "ANEES compares the errors that happened with the errors the filter expected (its "
         "covariance), averaged over runs and scans: " +
         dimension +
         " means it knows how wrong it is (as many components: " + components_text(study) +
         "), more means it is overconfident, less that it is conservative. '/ expected' divides it "
         "by " +
         dimension + "; the brackets hold what infinitely many runs would give in at least " +
         level +
         " of studies. Where a few runs decide the mean no interval holds it: 'heavy tail', and "
         "the median over runs follows with its interval. 'Would find' is the least ratio that "
         "this study finds with a probability of " +
         level_text(kPowerSaid) + ".";
}

std::string looks_note(const StudyAnalysis& study) {
  return "A cell of this study stops when its verdict is known, which is looked at after up to " +
         std::to_string(study.looks.size()) + " numbers of runs, " +
         std::to_string(study.looks[0]) +
         " first. Brackets and bands of the verdict are widened so that all looks together "
         "reject a consistent filter in at most " +
         level_text(1.0 - study.level) + " of studies. Those of other numbers are not.";
}

}  // namespace

std::vector<std::string> verdict_notes(const StudyAnalysis& study) {
  const std::string level = level_text(study.level), margin = exact_text(study.within);
  std::vector<std::string> notes = {
      anees_note(study, level),
      "'NEES of particles' is by the spread of the poses that a scan drew, on the scale on which a "
      "perfect filter of as many draws has 3, as a Gaussian filter has: all rows of this table are "
      "on one scale.",
      "'Consistent within " + margin + "': the brackets lie between 1/" + margin + " and " +
          margin +
          ", and no scan is shown to be farther off. 'Optimistic' or 'conservative by a to b': 1 "
          "is outside the brackets or, 'at t', a scan is outside a band that is wide enough for "
          "all scans together; a consistent filter is rejected so in at most " +
          level_text(1.0 - study.level) +
          " of studies, however long they are. 'Undecided': neither is shown; after so many more "
          "runs one of them will be, if runs go on to vary as they do.",
      "'Outside to the end from': all scans from then on are outside the band for all scans, so "
      "that, with a probability of " +
          level +
          ", the filter is off at every one of them; it may be so earlier. 'Never' means not "
          "within the " +
          readable(study.duration, 4) +
          " s of this study. A single run is lost when its own NEES is above its band for " +
          std::to_string(kLastingScans) + " scans in a row, or when it fails.",
      "'scans inside' counts the scans whose average lies in the pointwise band: " + level +
          " of them are expected of a consistent filter, and neighbouring scans are correlated.",
      "RMSE is the mean over runs, with the interval that holds it for infinitely many; ESS is the "
      "effective number of particles, roots how many of the first particles still have descendants "
      "at the end, CPU the filter's own time in a run; all of complete runs only."};
  if (study.looks.size() > 1) notes.push_back(looks_note(study));
  return notes;
}

std::vector<std::string> consistency_notes() {
  return {
      "Each row is one test: of the pose or of a part of it. The first covariance of a cell "
      "decides its verdict: the only one of a Kalman filter, 'corrected' of a particle filter. "
      "Only these are on one scale.",
      "The spread of few particles is too small by construction, and so is the mixture: 'ideal' is "
      "the ANEES of a perfect filter, the number of components or, by the spread of M particles "
      "that are independent draws from the truth's distribution, more. 'corrected' puts the NEES "
      "by the spread of the poses that a scan drew on a scale on which such a perfect filter has "
      "the number of components again (Hotelling's distribution of the effective number of draws "
      "to the chi-square), so that few draws alone make no filter optimistic. Where a scan drew "
      "none it is that of the mixture.",
      "'median' is the middle run instead of the average one, 'trimmed' the mean without the tenth "
      "of the runs at either end, each divided by what a consistent filter has: near 1 while ANEES "
      "is far too large they say that few bad runs make the average. 'lower rank' counts singular "
      "covariances: they are judged by the components that they leave. 'unusable' counts samples "
      "that are left out because error or covariance is not finite or the covariance is not "
      "positive semidefinite. 'too few draws' counts covariances of no more effective draws than "
      "components and two, of which no spread says anything, 'unjudged runs' complete runs in "
      "which no scan is left."};
}

std::vector<std::string> too_few_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr) continue;
    if (pose->series.unjudged_runs > 0) {
      notes.push_back(cell.label + ": " + std::to_string(pose->series.unjudged_runs) + " of " +
                      std::to_string(cell.complete) +
                      " complete runs have no scan that can be judged; ANEES and verdict are of "
                      "the other runs.");
    }
    if (pose->series.too_few == 0) continue;
    const double share =
        static_cast<double>(pose->series.too_few) / static_cast<double>(pose->series.samples);
    notes.push_back(cell.label + ": in " + std::to_string(pose->series.too_few) + " of " +
                    std::to_string(pose->series.samples) + " scans (" + percent(share) +
                    ") the weights leave no more than 5 effective draws (ESS), of which a "
                    "covariance of three components cannot be judged; ANEES and verdict are of "
                    "the other scans.");
  }
  return notes;
}

}  // namespace montecarta::analysis
