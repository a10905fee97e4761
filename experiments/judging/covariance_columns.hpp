// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/column_names.hpp"
#include "experiments/judging/state_shape.hpp"

#include <string>

namespace montecarta::experiments {

/// Fills what `fields`, whose shape is known, has of the covariance: columns cov_A_B of all
/// elements, of one triangle or of blocks between which there is no covariance; or columns sigma_A,
/// the standard deviations. Throws StudyError that begins with `place`.
void find_covariance(const Names& header, const std::string& place, EstimateFields& fields);

/// The same of a truth, which may have further elements. `columns` are without the prefix.
void find_covariance_of_truth(Names columns, const std::string& place, const std::string& prefix,
                              EstimateFields& fields);

}  // namespace montecarta::experiments
