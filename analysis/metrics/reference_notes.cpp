// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

/// "the drive", "2 of 3 drives".
std::string drives_in_words(const StudyAnalysis& study, const JudgedReference& reference) {
  if (study.own_drives == 0) return "the drive";
  return std::to_string(reference.drives) + " of " + std::to_string(study.own_drives) + " drives";
}

std::string fixes_note(const StudyAnalysis& study) {
  std::string sentence =
      "Estimates are compared with each reference at its fixes only, interpolated linearly in time "
      "between the poses that are stored:";
  for (const JudgedReference& reference : study.references) {
    sentence += " " + reference.name + " has " + std::to_string(reference.fixes) +
                " fixes within " + drives_in_words(study, reference) +
                (&reference == &study.references.back() ? "." : ",");
  }
  return sentence;
}

std::string baseline_note(const StudyAnalysis& study) {
  if (study.references.front().fixes == 0) {
    return "No fix of " + study.references.front().name + " lies within " +
           (study.own_drives == 0 ? "the drive" : "any drive") + ", so nothing can be said by it.";
  }
  const CellAnalysis* baseline = baseline_of(study);
  if (baseline == nullptr) return "No cell runs EKF-SLAM, so there is no baseline to beat.";
  const JudgedReference& reference = study.references.front();
  const Spread compared = baseline->get<ReferenceAnalyses>().front().over_runs(
      reference.compares_raw() ? &ReferenceScores::rms : &ReferenceScores::aligned_rms);
  return std::string("A run beats EKF-SLAM where its ") + reference.compared() + " RMS to " +
         reference.name + " is below the mean of " + baseline->label + ", " +
         readable(compared.summary.mean) + " m; failed runs beat nothing." +
         (reference.compares_raw() ? " It is compared as it stands, since the errors of the "
                                     "reference are known."
                                   : "");
}

std::vector<std::string> distance_notes(const StudyAnalysis& study) {
  return {
      "'raw' compares as it stands; 'aligned' first turns and shifts the estimated path as a whole "
      "(no stretching, no mirroring) to where it fits all fixes best, since nobody knows exactly "
      "where the drive began and which way the vehicle looked.",
      "The median is the middle fix and is hardly moved by outliers; 'gated' is the aligned RMS "
      "over the "
      "fixes within " +
          readable(kReferenceGate, 1) +
          " times the run's own median error, with the share kept: a single fix may be more than a "
          "hundred metres off. A filter that leaves the path half way keeps few fixes: read it "
          "with the "
          "share.",
      std::string(study.own_drives > 0
                      ? "Every run met a drive of its own, and those without a fix are left out"
                      : "Runs see the same drive and differ by the filter's own randomness alone") +
          ": numbers are means over runs +- their standard error; 'middle run' is the median over "
          "runs of the aligned RMS, with the best and the worst run.",
      "A run lost the map where it failed or the median of its aligned errors exceeds " +
          readable(kLostBeyond, 2) + " m."};
}

}  // namespace

std::string no_truth_sentence(const StudyAnalysis& study) {
  if (std::ranges::any_of(study.references, &JudgedReference::has_errors)) {
    return "This drive was recorded: nobody knows its true path. References whose own errors are "
           "stated take its place: the NEES at their fixes is by the covariance of both.";
  }
  return "This drive was recorded: nobody knows its true path, so there is no verdict on "
         "consistency (NEES) and no true error; estimates are judged by independent measurements "
         "of the path.";
}

std::vector<std::string> reference_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (!study.references.empty()) {
    notes = distance_notes(study);
    notes.insert(notes.begin(), fixes_note(study));
    notes.push_back(baseline_note(study));
  }
  if (study.beacons > 0) {
    notes.push_back(
        "A surveyed beacon is found where the final map, aligned like the path, has a landmark "
        "within " +
        readable(kFoundWithin, 1) +
        " m of it; its error is the RMS over the beacons found, as the map stands and aligned.");
  }
  if (study.own_drives > 0) {
    notes.emplace_back(
        "Every drive has scan times of its own, so no mean over runs is taken scan by scan: there "
        "are no series and no figures over time.");
  }
  notes.emplace_back(
      "Landmarks are those in the map after the last scan; ESS is the effective number of "
      "particles, roots how many of the first particles still have descendants at the end, CPU the "
      "filter's own time in a run; all of complete runs only.");
  return notes;
}

}  // namespace montecarta::analysis
