// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/calibration_figure.hpp"
#include "analysis/page/sections.hpp"
#include "analysis/tables/calibration_table.hpp"

namespace montecarta {

Section calibration_section(const StudyAnalysis& study) {
  if (!has_calibration(study)) return {};
  Section section{"Calibration"};
  add_table("calibration", calibration_table(study), section);
  add_notes(calibration_notes(study), section);
  section.figures = figure_section(calibration_figures(study)).figures;
  return section;
}

}  // namespace montecarta
