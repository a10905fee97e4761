// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"

namespace montecarta {

Section consistency_section(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  Section section{"The whole test"};
  add_table("consistency", consistency_table(study), section);
  add_notes(
      {"Each row is one test: of the pose or of a part of it, with the covariance of the particle "
       "mixture or of the particle spread. The first covariance of a cell decides its verdict.",
       "The spread of few particles is too small by construction: 'ideal' is the ANEES of a "
       "perfect "
       "filter, the number of components or, by the spread of M particles that are independent "
       "draws "
       "from the truth's distribution, more. 'corrected' puts the NEES by the spread on a scale on "
       "which such a perfect filter has the number of components again (Hotelling's distribution "
       "of "
       "M draws to the chi-square), so that M alone makes no filter inconsistent.",
       "'median' is the middle run instead of the average one, 'trimmed' the mean without the "
       "tenth "
       "of the runs at either end, each divided by what a right filter has: near 1 while ANEES is "
       "far too large they say that few bad runs make the average. 'floored' counts covariances "
       "that were singular (0.1 mm and "
       "0.00001 rad were added), 'undefined' those that were not a number and left out."},
      section);
  return section;
}

}  // namespace montecarta
