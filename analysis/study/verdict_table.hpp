// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/imported_state.hpp"
#include "analysis/run/nees.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/nees_result.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/verdict/verdict.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// A table with one row for each cell, narrow enough for a terminal: complete runs, verdict, NEES
/// ratio with its interval, RMSE of position and heading, ancestors and cost. Columns without a
/// number are left out, and so are runs if every cell completed all runs of the file.
TextTable summary_table(const StudyAnalysis& study);

/// A table with one row for each cell: its runs, the verdict, and the numbers behind it.
TextTable verdict_table(const StudyAnalysis& study);

/// A table with one row for each cell: errors, effective particles and cost of a run.
TextTable accuracy_table(const StudyAnalysis& study);

/// A table with one row for each cell and definition of covariance and error: the average NEES.
TextTable consistency_table(const StudyAnalysis& study);

/// The single numbers of one average NEES. The band is that of all complete runs.
Frame::Row numbers_of(const CellAnalysis& cell, const NeesResult& nees, double level);

/// A member of a family as a row of a file.
Frame::Row family_row(const FamilyTest& test, const Member& member);
/// The members of a family, one in each row, the same for CSV and HDF5.
Frame family_frame(const FamilyTest& test);

/// A table with one row for each failed run: cell, run, step, reason.
TextTable failure_table(const StudyAnalysis& study);

/// Heading of a column of ratios: "NEES ratio [95 %]", or "NIS ratio [95 %]" of innovations.
std::string ratio_heading(const StudyAnalysis& study);
/// Explains the NEES ratio.
std::string ratio_note(const StudyAnalysis& study);

/// Explains the answers of a verdict.
std::string answers_note(const StudyAnalysis& study);

/// Notes on the verdict table, for readers who do not know the chi-square distribution.
std::vector<std::string> verdict_notes(const StudyAnalysis& study);

/// The NEES ratio that the corrected spread of particles shows on average if squared errors are
/// twice those of an ideal sampler with the cell's mean number of effective draws (STATISTICS 4).
/// nullopt if the cell is not judged by that spread.
std::optional<double> shown_for_twice(const CellAnalysis& cell);

/// Cautions, at most one sentence each, on runs, scans and covariances that the verdict judges in
/// part or not at all, and on ratios that few particles show too near to 1. Cells in which this
/// affects less than one in a hundred are not named; consistency_table() has all counts.
std::vector<std::string> cautions(std::span<const CellAnalysis> cells,
                                  const ImportedState& imported);

/// The runs of a cell in words: "40 complete", "2 FAILED, 38 complete", ...
std::string runs_in_words(const CellAnalysis& cell);

/// Tone of an answer: consistent is good news; optimistic and inconsistent are bad news.
Tone tone_of(Answer answer);
/// Tone of the answer of a verdict, except that a slight deviation is neither good nor bad news.
Tone tone_of(const Verdict& verdict);
/// Tone of the number of runs of a cell: failed runs are bad news.
Tone tone_of_runs(const CellAnalysis& cell);

/// The NEES ratio with its interval; "-" if it is not tested.
std::string ratio_text(const CellAnalysis& cell);
std::string ratio_text_of(const Verdict& verdict);

/// The mean of a score over the complete runs of a cell, in words.
struct MeanText {
  std::string mean;    ///< mean with its interval, or alone if the scores have a heavy tail
  std::string median;  ///< median with its median_interval() if they have a heavy tail, else empty

  /// Text of mean and median: "0.29 [0.22, 0.37]", "3.1 (heavy tail), median 0.4 [0.3, 0.6]".
  std::string text() const;
};

/// The mean of a score with the interval of the cell. If the values have a heavy tail, no interval
/// of the mean is valid: the median then follows, with an interval at `level` unless there are too
/// few runs for one. All numbers are multiplied by `factor`.
MeanText score_text(const CellAnalysis& cell, std::string_view score, double level,
                    double factor = 1.0);

}  // namespace montecarta::analysis
