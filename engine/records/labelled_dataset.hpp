// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"

#include <map>
#include <string>
#include <vector>

namespace montecarta::engine {

/// What a reader wants to know of a dataset besides its numbers.
struct Label {
  std::string units;
  std::string long_name;
};

/// Dimension scales by the name of their dimension.
using Scales = std::map<std::string, h5::Handle, std::less<>>;

/// A dataset with its label over dimensions whose scales exist.
h5::Handle add_dataset(const h5::Handle& parent, const std::string& name, Element element,
                       const h5::Shape& shape, const std::vector<std::string>& dimensions,
                       const Label& label, const Scales& scales);
/// One text of at most `width` bytes; what it lacks is zeros.
h5::Handle add_text(const h5::Handle& parent, const std::string& name, const std::string& text,
                    std::size_t width, const Label& label);
/// Creates the scale of dimension `name`, which `scales` then holds in place of one of that name.
void add_scale(const h5::Handle& parent, const std::string& name, const std::vector<double>& values,
               const Label& label, Scales& scales);
void add_scale(const h5::Handle& parent, const std::string& name,
               const std::vector<std::uint64_t>& values, const Label& label, Scales& scales);
/// A scale that counts 0, 1, ..., length - 1.
void add_index_scale(const h5::Handle& parent, const std::string& name, std::size_t length,
                     const Label& label, Scales& scales);

}  // namespace montecarta::engine
