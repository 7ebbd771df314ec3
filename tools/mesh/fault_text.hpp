#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {

/// Up to 20 indices in the file; items that are not in it (negative) are "new".
std::string list_numbers(const std::vector<long>& numbers);

/// Warns if a body is much larger or smaller than anything that a hand can hold.
void add_size_fault(const Eigen::Matrix3Xd& points, std::vector<Fault>& faults);

}  // namespace palpate::mesh_tool
