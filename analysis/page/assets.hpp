// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace montecarta::analysis {

/// The style sheet of the page: analysis/page/page.css, put into the program when it is built.
std::string_view page_style();
/// The scripts of the page, analysis/page/script/*.js in the order in which they need each other,
/// as the body of one function.
std::string_view page_script();

}  // namespace montecarta::analysis
