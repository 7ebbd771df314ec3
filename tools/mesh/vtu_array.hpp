#pragma once

#include <boost/property_tree/ptree.hpp>
#include <string>
#include <vector>

namespace palpate::mesh_tool {

/// How the arrays of a .vtu are stored.
struct VtuStorage {
  bool is_compressed = false;    // zlib
  bool has_wide_header = false;  // lengths of 64 bits, not 32
  bool appended_is_raw = false;
  std::string appended;  // what stands behind the underscore of AppendedData
};

/// The numbers of a DataArray. Throws std::runtime_error saying what is wrong.
std::vector<double> read_vtu_array(const boost::property_tree::ptree& array,
                                   const VtuStorage& storage);

}  // namespace palpate::mesh_tool
