// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/list_text.hpp"

namespace montecarta::engine {

std::string joined(std::span<const std::string> parts, std::string_view between) {
  std::string list;
  for (const std::string& part : parts) {
    if (&part != parts.data()) list += between;
    list += part;
  }
  return list;
}

void append_part(std::string& list, std::string_view part, std::string_view between) {
  if (!list.empty()) list += between;
  list += part;
}

}  // namespace montecarta::engine
