// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"

namespace montecarta {

Section consistency_section(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  Section section{"The whole test"};
  add_table("consistency", consistency_table(study), section);
  add_notes(
      {"Each row is one test: of the pose or of a part of it, with the covariance of the particle "
       "mixture or of the particle spread. The spread of few particles is too small by "
       "construction, so the mixture decides where there is one.",
       "'ideal' is the ANEES of a perfect filter: the number of components; with the spread of M "
       "particles that are independent draws from the truth's distribution it is larger, since so "
       "few draws cannot tell their covariance better.",
       "'median' is the middle run instead of the average one: far below ANEES it says that few "
       "bad runs make the average. 'floored' counts covariances that were singular (0.1 mm and "
       "0.00001 rad were added), 'undefined' those that were not a number and left out."},
      section);
  return section;
}

}  // namespace montecarta
