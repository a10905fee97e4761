// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/page/sections.hpp"

namespace montecarta::analysis {

Section failure_section(const StudyAnalysis& study) {
  if (!study.has_failures()) return {};
  Section section{"failures", "Failed runs"};
  section.add("failures", failure_table(study));
  section.add(std::vector<std::string>{
      "These runs ended early and are left out of everything else; the step counts from 0. "
      "If they failed because the filter diverged, what is left looks better than the "
      "filter is."});
  return section;
}

}  // namespace montecarta::analysis
