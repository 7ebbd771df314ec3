#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {

/// Up to 20 numbers of a file; what is not in it (a negative number) is "new".
std::string list_numbers(const std::vector<long>& numbers);

/// Warns where a body is far larger or smaller than anything that a hand can hold.
void add_size_fault(const Eigen::Matrix3Xd& points, std::vector<Fault>& faults);

}  // namespace palpate::mesh_tool
