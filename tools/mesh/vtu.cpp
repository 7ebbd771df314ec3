#include "core/math/parse_number.hpp"
#include "core/mesh/connectivity.hpp"
#include "tools/mesh/mesh_files.hpp"

#include <zlib.h>

#include <algorithm>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/report.hpp"
#include "tools/common/base64.hpp"

namespace palpate::mesh_tool {
namespace {

/// Storage of the arrays of a .vtu.
struct VtuStorage {
  bool is_compressed = false;    // zlib
  bool has_wide_header = false;  // 64-bit lengths instead of 32-bit ones
  bool appended_is_raw = false;
  std::string appended;  // content after the underscore of AppendedData
};

// Of one array; more is treated as damage.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 33;

std::vector<double> parse_ascii(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    double number = 0;
    if (!math::parse_number(word, number))
      throw std::runtime_error("'" + word + "' is not a number");
    numbers.push_back(number);
  }
  return numbers;
}

template <typename Number>
std::vector<double> convert(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Number number;
    std::memcpy(&number, &bytes[i * sizeof number], sizeof number);
    numbers[i] = static_cast<double>(number);
  }
  return numbers;
}

std::vector<double> convert(const std::string& bytes, const std::string& type) {
  static const std::map<std::string, std::vector<double> (*)(const std::string&)> kTypes{
      {"Float32", convert<float>},      {"Float64", convert<double>},
      {"Int8", convert<std::int8_t>},   {"UInt8", convert<std::uint8_t>},
      {"Int16", convert<std::int16_t>}, {"UInt16", convert<std::uint16_t>},
      {"Int32", convert<std::int32_t>}, {"UInt32", convert<std::uint32_t>},
      {"Int64", convert<std::int64_t>}, {"UInt64", convert<std::uint64_t>}};
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) throw std::runtime_error("numbers of type '" + type + "'");
  return found->second(bytes);
}

/// Bytes of one array, header first, from base64 or raw storage that may be followed by other data.
class Block {
 public:
  Block(const std::string& storage, std::size_t from, bool is_raw) : storage_(storage), at_(from) {
    if (!is_raw) {
      // Header and data are encoded separately, or together: decoding whatever is present handles
      // both.
      const std::size_t end = storage.find_first_not_of(
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/= \t\r\n", from);
      decoded_ =
          common::from_base64(storage.substr(from, end == std::string::npos ? end : end - from));
      bytes_ = &decoded_;
      at_ = 0;
    }
  }
  std::uint64_t length(bool wide) {
    std::uint64_t value = 0;
    std::memcpy(&value, take(wide ? 8 : 4).data(), wide ? 8 : 4);
    if (value > kMostBytes) throw std::runtime_error("a length that cannot be");
    return value;
  }
  std::string take(std::uint64_t count) {
    if (at_ > bytes_->size() || bytes_->size() - at_ < count)
      throw std::runtime_error("the data end too early");
    at_ += count;
    return bytes_->substr(at_ - count, count);
  }

 private:
  const std::string& storage_;
  std::string decoded_;
  const std::string* bytes_ = &storage_;
  std::size_t at_;
};

std::string unpack(Block& block, const VtuStorage& storage) {
  const bool wide = storage.has_wide_header;
  if (!storage.is_compressed) return block.take(block.length(wide));
  const std::uint64_t blocks = block.length(wide), size = block.length(wide),
                      last = block.length(wide);
  if (blocks > kMostBytes / (size + 1)) throw std::runtime_error("a length that cannot be");
  std::vector<std::uint64_t> lengths;
  for (std::uint64_t b = 0; b < blocks; ++b) lengths.push_back(block.length(wide));
  std::string bytes;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::string packed = block.take(lengths[b]);
    std::string plain(b + 1 == blocks && last > 0 ? last : size, '\0');
    // zlib compresses by a factor of at most a thousand: a larger size is damage, for which no
    // memory is allocated.
    if (plain.size() > 2000 * packed.size() + 1000) throw std::runtime_error("a length that lies");
    uLongf count = plain.size();
    if (uncompress(reinterpret_cast<Bytef*>(plain.data()), &count,
                   reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
        count != plain.size()) {
      throw std::runtime_error("data that zlib cannot unpack");
    }
    bytes += plain;
  }
  return bytes;
}

/// The numbers of a DataArray. Throws std::runtime_error with the reason.
std::vector<double> read_vtu_array(const boost::property_tree::ptree& array,
                                   const VtuStorage& storage) {
  const auto format = array.get<std::string>("<xmlattr>.format", "ascii");
  const auto type = array.get<std::string>("<xmlattr>.type", "");
  if (format == "ascii") return parse_ascii(array.data());
  if (format == "binary") {
    const std::string text = array.data();
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return {};
    // Compressed data begin as a new block after the header's padding, which the decoder continues
    // with.
    Block block(text, first, false);
    return convert(unpack(block, storage), type);
  }
  if (format != "appended") throw std::runtime_error("format '" + format + "'");
  const auto offset = array.get<std::uint64_t>("<xmlattr>.offset", 0);
  if (offset > storage.appended.size()) throw std::runtime_error("an offset behind the file's end");
  Block block(storage.appended, offset, storage.appended_is_raw);
  return convert(unpack(block, storage), type);
}

using boost::property_tree::ptree;
using mesh::ElementOrder;

constexpr char kGroup[] = "group:";

// Numbers of VTK's cell types.
constexpr int kTetrahedron = 10, kQuadraticTetrahedron = 24;
int corners_of_other(int type) {
  return type == 12 || type == 25   ? 8
         : type == 13 || type == 26 ? 6
         : type == 14 || type == 27 ? 5
                                    : 0;
}

class VtuReader {
 public:
  VtuReader(std::istream& stream, std::string name, mesh::OnFault on_fault)
      : name_(std::move(name)), on_fault_(on_fault) {
    std::string text(std::istreambuf_iterator<char>(stream), {});
    cut_appended(text);
    std::istringstream xml(text);
    try {
      read_xml(xml, tree_);
    } catch (const boost::property_tree::xml_parser_error& error) {
      throw mesh::ParseError(name_ + ":" + std::to_string(error.line()) + ": " + error.message());
    }
  }

  mesh::MeshWithGroups read() {
    const ptree& file = child(tree_, "VTKFile");
    if (file.get<std::string>("<xmlattr>.type", "") != "UnstructuredGrid")
      fail("is no UnstructuredGrid");
    if (file.get<std::string>("<xmlattr>.byte_order", "LittleEndian") != "LittleEndian")
      fail("is of the other byte order");
    const auto compressor = file.get<std::string>("<xmlattr>.compressor", "");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail("is packed by " + compressor + "; allowed: vtkZLibDataCompressor or none");
    storage_.is_compressed = !compressor.empty();
    storage_.has_wide_header = file.get<std::string>("<xmlattr>.header_type", "UInt32") == "UInt64";
    const ptree& grid = child(file, "UnstructuredGrid");
    if (grid.count("Piece") != 1) fail("must hold one Piece");
    read_piece(grid.get_child("Piece"));
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw mesh::ParseError(name_ + ": " + what);
  }

  const ptree& child(const ptree& of, const std::string& key) const {
    const auto found = of.get_child_optional(key);
    if (!found) fail("there is no " + key);
    return *found;
  }

  /// Raw bytes are not XML: they are removed before parsing.
  void cut_appended(std::string& text) {
    const std::size_t open = text.find("<AppendedData");
    if (open == std::string::npos) return;
    const std::size_t begin = text.find('_', text.find('>', open)),
                      end = text.rfind("</AppendedData>");
    if (begin == std::string::npos || end == std::string::npos || end < begin)
      fail("AppendedData without '_' or end");
    storage_.appended_is_raw =
        text.substr(open, text.find('>', open) - open).find("base64") == std::string::npos;
    storage_.appended = text.substr(begin + 1, end - begin - 1);
    text.erase(begin, end - begin);
  }

  std::vector<double> numbers(const ptree& array, const std::string& what) const {
    try {
      return read_vtu_array(array, storage_);
    } catch (const std::exception& error) {
      fail(what + ": " + error.what());
    }
  }
  std::vector<double> named(const ptree& section, const std::string& key) const {
    for (const auto& [tag, array] : section) {
      if (tag == "DataArray" && array.get<std::string>("<xmlattr>.Name", "") == key)
        return numbers(array, key);
    }
    fail("there is no DataArray " + key);
  }

  void read_piece(const ptree& piece) {
    const std::vector<double> points =
        numbers(child(child(piece, "Points"), "DataArray"), "Points");
    if (points.size() % 3 != 0) fail("Points are not three numbers each");
    const ptree& cells = child(piece, "Cells");
    const std::vector<double> nodes = named(cells, "connectivity"), ends = named(cells, "offsets"),
                              types = named(cells, "types");
    if (ends.size() != types.size()) fail("offsets and types are of unlike length");
    points_ = Eigen::Map<const Eigen::Matrix3Xd>(points.data(), 3, points.size() / 3);
    if (on_fault_ == mesh::OnFault::kThrow && !points_.allFinite())
      fail("a coordinate is not finite");
    std::vector<int> cell_of_tetrahedron;
    double begin = 0;
    for (std::size_t c = 0; c < types.size(); ++c) {
      if (!(ends[c] >= begin) || ends[c] > static_cast<double>(nodes.size()))
        fail("offset of cell " + std::to_string(c) + " is wrong");
      std::vector<int> members;
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(ends[c]); ++i)
        members.push_back(node(nodes[i], c));
      add_cell(static_cast<int>(c), static_cast<int>(types[c]), members, cell_of_tetrahedron);
      begin = ends[c];
    }
    if (tetrahedra_.empty() && result_.others.empty()) fail("holds no tetrahedra");
    keep_nodes();
    read_groups(piece, cell_of_tetrahedron, types.size());
  }

  int node(double number, std::size_t cell) const {
    const bool exists = number >= 0 && number < static_cast<double>(points_.cols());
    if (!exists && on_fault_ == mesh::OnFault::kThrow)
      fail("cell " + std::to_string(cell) + " names a node that is not there");
    return exists ? static_cast<int>(number) : -1;
  }

  void add_cell(int cell, int type, const std::vector<int>& members, std::vector<int>& cells) {
    const int others = corners_of_other(type);
    const std::size_t wanted = type == kTetrahedron            ? 4
                               : type == kQuadraticTetrahedron ? 10
                                                               : static_cast<std::size_t>(others);
    if (wanted == 0) return;
    if (members.size() < wanted) fail("cell " + std::to_string(cell) + " has too few nodes");
    if (others > 0) {
      if (on_fault_ == mesh::OnFault::kThrow) {
        fail("cell " + std::to_string(cell) +
             " is no tetrahedron (palpate-mesh repair splits others)");
      }
      mesh::OtherCell& other = result_.others.emplace_back();
      other.corner_count = others;
      other.number = cell;
      std::copy_n(members.begin(), others, other.corners.begin());
      return;
    }
    tetrahedra_.emplace_back(members[0], members[1], members[2], members[3]);
    result_.tetrahedron_numbers.push_back(cell);
    cells.push_back(cell);
    for (int e = 0; e < 6 && type == kQuadraticTetrahedron; ++e) {
      const auto& [a, b] = mesh::kTetrahedronEdges[e];
      if (members[a] < 0 || members[b] < 0 || members[4 + e] < 0) continue;
      middle_nodes_.push_back(members[4 + e]);
      result_.middles[std::minmax(members[a], members[b])] = points_.col(members[4 + e]);
    }
  }

  /// Corners, and, if faults are to be kept, nodes of no cell; others are omitted.
  void keep_nodes() {
    std::vector<bool> keep(points_.cols(), on_fault_ == mesh::OnFault::kKeep);
    for (const int n : middle_nodes_) keep[n] = false;
    for (const Eigen::Vector4i& t : tetrahedra_) {
      for (const int n : t)
        if (n >= 0) keep[n] = true;
    }
    for (const mesh::OtherCell& cell : result_.others) {
      for (int i = 0; i < cell.corner_count; ++i)
        if (cell.corners[i] >= 0) keep[cell.corners[i]] = true;
    }
    const std::vector<int> number = mesh::new_numbers(keep), kept = mesh::indices_of(keep);
    result_.node_numbers.assign(kept.begin(), kept.end());
    const auto renumber = [&number](int n) { return n < 0 ? -1 : number[n]; };
    result_.mesh.nodes = points_(Eigen::all, kept);
    result_.mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra_.size()));
    for (int t = 0; t < result_.mesh.tetrahedron_count(); ++t)
      result_.mesh.tetrahedra.col(t) = tetrahedra_[t].unaryExpr(renumber);
    for (mesh::OtherCell& cell : result_.others)
      for (int i = 0; i < cell.corner_count; ++i) cell.corners[i] = renumber(cell.corners[i]);
    mesh::EdgeMiddles middles;
    for (const auto& [edge, middle] : result_.middles)
      middles.emplace(std::minmax(renumber(edge.first), renumber(edge.second)), middle);
    result_.middles = std::move(middles);
  }

  void read_groups(const ptree& piece, const std::vector<int>& cells, std::size_t cell_count) {
    const auto data = piece.get_child_optional("CellData");
    if (!data) return;
    for (const auto& [tag, array] : *data) {
      const auto key = tag == "DataArray" ? array.get<std::string>("<xmlattr>.Name", "") : "";
      if (key.rfind(kGroup, 0) != 0) continue;
      const std::vector<double> flags = numbers(array, key);
      if (flags.size() != cell_count) fail(key + " has not one number a cell");
      mesh::MeshGroup group;
      std::vector<bool> used(result_.mesh.node_count(), false);
      for (std::size_t t = 0; t < cells.size(); ++t) {
        if (flags[cells[t]] == 0) continue;
        group.tetrahedra.push_back(static_cast<int>(t));
        for (const int n : result_.mesh.tetrahedra.col(static_cast<int>(t)))
          if (n >= 0) used[n] = true;
      }
      for (int n = 0; n < result_.mesh.node_count(); ++n)
        if (used[n]) group.nodes.push_back(n);
      if (!group.tetrahedra.empty())
        result_.groups[key.substr(sizeof kGroup - 1)] = std::move(group);
    }
  }

  std::string name_;
  mesh::OnFault on_fault_;
  ptree tree_;
  VtuStorage storage_;
  Eigen::Matrix3Xd points_;
  std::vector<Eigen::Vector4i> tetrahedra_;
  std::vector<int> middle_nodes_;
  mesh::MeshWithGroups result_;
};

}  // namespace

mesh::MeshWithGroups read_vtu(std::istream& stream, const std::string& name,
                              mesh::OnFault on_fault) {
  return VtuReader(stream, name, on_fault).read();
}

void write_vtu(const mesh::MeshWithGroups& mesh, ElementOrder order, VtuEncoding encoding,
               std::ostream& out) {
  const mesh::ElementMesh elements = mesh::element_mesh(mesh, order);
  const int count = elements.element_count();
  common::Grid grid;
  grid.points = elements.nodes;
  grid.kind = order == ElementOrder::kQuadratic ? common::CellKind::kQuadraticTetrahedron
                                                : common::CellKind::kTetrahedron;
  grid.cells = elements.elements;
  Eigen::RowVectorXd quality(count);
  for (int t = 0; t < count; ++t) quality[t] = mesh::radius_ratio(mesh.mesh, t);
  grid.cell_fields.push_back({"quality", quality});
  for (const auto& [name, group] : mesh.groups) {
    if (group.tetrahedra.empty()) continue;
    Eigen::RowVectorXd flags = Eigen::RowVectorXd::Zero(count);
    for (const int t : group.tetrahedra) flags[t] = 1;
    grid.cell_fields.push_back({kGroup + name, flags, true});
  }
  common::write_vtu(grid, encoding, out);
}

}  // namespace palpate::mesh_tool
