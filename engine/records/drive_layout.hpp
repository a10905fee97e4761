// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/labelled_dataset.hpp"
#include "engine/records/result_description.hpp"

#include <vector>

namespace montecarta::engine {

/// Group `references` in `scenario`, or in one of its drives; nothing where there are none.
void add_references(const h5::Handle& scenario, const std::vector<ReferencePath>& references,
                    Scales& scales);
/// Group `drives` in `scenario`, with a group for each; nothing where there are none.
void add_own_drives(const h5::Handle& scenario, const std::vector<OwnDrive>& drives,
                    Scales& scales);

std::vector<ReferencePath> read_references(const h5::Handle& scenario);
std::vector<OwnDrive> read_own_drives(const h5::Handle& scenario);

}  // namespace montecarta::engine
