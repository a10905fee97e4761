// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_filter.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/setup/filter_setup.hpp"

#include <memory>

namespace montecarta {

/// `Real` = double is the same filter one particle at a time, for tests.
template <class Real, Choice choice>
std::unique_ptr<SlamFilter> make_marginal(const FilterSetup& setup) {
  return std::make_unique<MarginalFilter<Real>>(setup, marginal_settings(setup.options, choice));
}

/// Lines for the table of factory.cpp.
FilterKind marginal_kind();
FilterKind ampf_de_kind();

}  // namespace montecarta
