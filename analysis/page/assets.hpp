// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace montecarta {

/// The style sheet of the page: analysis/page/page.css, put into the program when it is built.
std::string_view page_style();

}  // namespace montecarta
