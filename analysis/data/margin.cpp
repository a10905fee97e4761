// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/margin.hpp"

#include "analysis/data/study_setting.hpp"
#include "engine/errors.hpp"

#include <charconv>

namespace montecarta::analysis {

double margin_in(const std::string& study_text) {
  const auto text = study_setting(study_text, "within");
  if (!text) return kUsualMargin;
  double margin = 0.0;
  const char* const last = text->data() + text->size();
  const auto [end, error] = std::from_chars(text->data(), last, margin);
  const bool is_good = error == std::errc() && end == last && margin >= kLeastMargin;
  if (is_good && margin <= kMostMargin) return margin;
  throw StudyError("study.within = " + *text +
                   " (a ratio from 1.001 to 100 is needed): choose another file");
}

}  // namespace montecarta::analysis
