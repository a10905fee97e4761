// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/named_rows.hpp"

#include "analysis/output/number_text.hpp"

namespace montecarta::analysis {

std::string heading(const std::string& name, const std::string& units) {
  return units == "1" ? name : name + " [" + units + "]";
}

void NamedRows::row(const std::vector<std::pair<std::string, std::string>>& texts,
                    const std::vector<NamedNumber>& numbers) {
  std::vector<std::string> headings, fields;
  for (const auto& [name, text] : texts) {
    headings.push_back(name);
    fields.push_back(text);
  }
  for (const NamedNumber& number : numbers) {
    headings.push_back(heading(number.name, number.units));
    fields.push_back(exact_text(number.value));
  }
  if (!is_headed_) file_.row(headings);
  is_headed_ = true;
  file_.row(fields);
}

}  // namespace montecarta::analysis
