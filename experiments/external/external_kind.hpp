// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"

#include <span>

namespace montecarta::experiments {

/// Whether a cell may start the program that it names. Who runs a study says so; the study does
/// not.
enum class ExternalPrograms { refused, allowed };

/// The option that says it, without dashes.
inline constexpr const char* kAllowExternal = "allow-external";

/// A program outside of ours: "cell = external command="python3 my_filter.py" label=mine".
FilterKind external_kind();

/// Whether cells of this kind start a program.
bool starts_program(const FilterKind& filter);

/// What a study may name: the filters of the table, then `external`.
std::span<const FilterKind> known_filters();

}  // namespace montecarta::experiments
