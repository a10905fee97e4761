// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"

namespace montecarta {

Section failure_section(const StudyAnalysis& study) {
  if (!study.has_failures()) return {};
  Section section{"Failed runs"};
  add_table("failures", failure_table(study), section);
  add_notes({"These runs ended early and are left out of everything else; the step counts from 0. "
             "If they failed because the filter diverged, what is left looks better than the "
             "filter is."},
            section);
  return section;
}

}  // namespace montecarta
