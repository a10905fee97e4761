// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace montecarta {

/// The enumerator at the place of `choice` among `choices`, which stand in the enumerators' order
/// and hold it: an option's value was checked before.
template <class Enumerator>
Enumerator chosen(const std::string& choice, const std::vector<std::string>& choices) {
  return static_cast<Enumerator>(std::find(choices.begin(), choices.end(), choice) -
                                 choices.begin());
}

}  // namespace montecarta
