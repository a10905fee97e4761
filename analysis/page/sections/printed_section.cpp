// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"
#include "analysis/page/sections.hpp"
#include "analysis/printed/comparison.hpp"

namespace montecarta::analysis {
namespace {

std::string assumptions(const Printed& printed) {
  if (printed.assumptions.empty()) return "";
  std::string list = "<p>What the paper leaves open, and what we assume:</p>\n<ul>\n";
  for (const std::string& each : printed.assumptions) {
    list += "<li>" + html_escape(each) + "</li>\n";
  }
  return list + "</ul>\n";
}

}  // namespace

Section printed_section(const StudyAnalysis& study) {
  if (study.printed.empty()) return {};
  Section section{"printed", "Printed and measured"};
  if (!study.printed.source.empty()) {
    section.add_html("<p>" + html_escape(study.printed.source) + "</p>\n");
  }
  section.add("printed", printed_value_table(study));
  section.add("claims", printed_claim_table(study));
  section.add(printed_notes(study));
  section.add_html(assumptions(study.printed));
  return section;
}

}  // namespace montecarta::analysis
