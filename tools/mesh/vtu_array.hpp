#pragma once

#include <boost/property_tree/ptree.hpp>
#include <string>
#include <vector>

namespace palpate::mesh_tool {

/// Storage of the arrays of a .vtu.
struct VtuStorage {
  bool is_compressed = false;    // zlib
  bool has_wide_header = false;  // 64-bit lengths instead of 32-bit ones
  bool appended_is_raw = false;
  std::string appended;  // content after the underscore of AppendedData
};

/// The numbers of a DataArray. Throws std::runtime_error with the reason.
std::vector<double> read_vtu_array(const boost::property_tree::ptree& array,
                                   const VtuStorage& storage);

}  // namespace palpate::mesh_tool
