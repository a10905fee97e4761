// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/section.hpp"

namespace montecarta::analysis {

bool Section::has_content() const { return !figures.empty() || all<Note>().size() < blocks.size(); }

void Section::add(const std::string& table_name, const TextTable& table) {
  if (!table.rows.empty()) blocks.emplace_back(Table{table_name, table});
}

void Section::add(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) blocks.emplace_back(Note{note});
}

void Section::add_notes(std::string_view key, const Values& values) {
  add(paragraphs(name, key, values));
}

void Section::add_html(const std::string& html) { blocks.emplace_back(Html{html}); }

Section section_of(std::string_view name, const Values& values) {
  const std::vector<std::string> texts = paragraphs(name, "section", values);
  Section section{std::string(name), texts.front()};
  if (texts.size() > 1) section.summary = texts[1];
  return section;
}

const std::vector<SectionPlace>& reading_order() {
  static const std::vector<SectionPlace> order = {
      {"title", {}, Section::Shown::open},
      {"sweep", {}, Section::Shown::open, "sweep_"},
      {"cards", {}, Section::Shown::open},
      {"drive", {}, Section::Shown::open},
      {"references", {"reference_error"}, Section::Shown::open},
      {"own_drives", {}, Section::Shown::open},
      {"nees", {"anees"}, Section::Shown::open},
      {"replay", {}, Section::Shown::open},
      {"errors",
       {"rmse", "position_boxes", "heading_boxes", "error_envelopes"},
       Section::Shown::open},
      {"verdict"},
      {"failures"},
      {"components"},
      {"paths"},
      {"map_errors"},
      {"map_size"},
      {"joint_nees"},
      {"observability"},
      {"evolution"},
      {"smoother"},
      {"innovations", {"nis", "whiteness"}},
      {"calibration", {"nees_quantiles", "calibration", "ranks"}},
      {"diversity", {"diversity", "ess", "ancestry"}},
      {"association"},
      {"proper_scores"},
      {"comparison"},
      {"families"},
      {"consistency", {"anees_parts"}},
  };
  return order;
}

}  // namespace montecarta::analysis
