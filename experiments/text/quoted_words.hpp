// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// The parts of `text` between runs of white space, where quotes, '...' or "...", hold a part or
/// some of it together and are dropped. Within "..." a backslash takes the character behind it as
/// it is, everywhere else it is a character like any other. Nothing is expanded. Throws StudyError,
/// worded "(why): remedy", where a quote is not closed.
std::vector<std::string> quoted_words(std::string_view text);

/// `word` in double quotes, so that quoted_words() reads it back.
std::string in_quotes(std::string_view word);

}  // namespace montecarta::experiments
