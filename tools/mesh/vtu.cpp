#include "tools/mesh/vtu.hpp"

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <sstream>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/report.hpp"
#include "tools/common/base64.hpp"
#include "tools/mesh/vtu_array.hpp"

namespace palpate::mesh_tool {
namespace {

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
      for (const int n : t) {
        if (n >= 0) keep[n] = true;
      }
    }
    for (const mesh::OtherCell& cell : result_.others) {
      for (int i = 0; i < cell.corner_count; ++i) {
        if (cell.corners[i] >= 0) keep[cell.corners[i]] = true;
      }
    }
    std::vector<int> number(points_.cols(), -1);
    for (int n = 0; n < points_.cols(); ++n) {
      if (!keep[n]) continue;
      number[n] = static_cast<int>(result_.node_numbers.size());
      result_.node_numbers.push_back(n);
    }
    const auto renumber = [&number](int n) { return n < 0 ? -1 : number[n]; };
    result_.mesh.nodes = points_(
        Eigen::all, std::vector<int>(result_.node_numbers.begin(), result_.node_numbers.end()));
    result_.mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra_.size()));
    for (int t = 0; t < result_.mesh.tetrahedron_count(); ++t)
      result_.mesh.tetrahedra.col(t) = tetrahedra_[t].unaryExpr(renumber);
    for (mesh::OtherCell& cell : result_.others) {
      for (int i = 0; i < cell.corner_count; ++i) cell.corners[i] = renumber(cell.corners[i]);
    }
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
        for (const int n : result_.mesh.tetrahedra.col(static_cast<int>(t))) {
          if (n >= 0) used[n] = true;
        }
      }
      for (int n = 0; n < result_.mesh.node_count(); ++n) {
        if (used[n]) group.nodes.push_back(n);
      }
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

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return result;
}

class VtuWriter {
 public:
  VtuWriter(VtuEncoding encoding, std::ostream& out) : encoding_(encoding), out_(out) {}

  template <typename Number>
  void array(const std::string& name, const std::string& type, int components,
             const std::vector<Number>& numbers) {
    const bool ascii = encoding_ == VtuEncoding::kAscii;
    out_ << "        <DataArray type=\"" << type << "\" Name=\"" << escaped(name)
         << "\" NumberOfComponents=\"" << components << "\" format=\""
         << (ascii ? "ascii" : "binary") << "\">\n";
    if (ascii) {
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        out_ << text(numbers[i]) << (i % 12 == 11 || i + 1 == numbers.size() ? '\n' : ' ');
      }
    } else {
      const std::uint64_t length = numbers.size() * sizeof(Number);
      std::string bytes(reinterpret_cast<const char*>(&length), sizeof length);
      bytes.append(reinterpret_cast<const char*>(numbers.data()), length);
      out_ << common::to_base64(bytes) << '\n';
    }
    out_ << "        </DataArray>\n";
  }

 private:
  static std::string text(double value) { return mesh::shortest(value); }
  static std::string text(std::int64_t value) { return std::to_string(value); }
  static std::string text(std::uint8_t value) { return std::to_string(int{value}); }

  VtuEncoding encoding_;
  std::ostream& out_;
};

}  // namespace

mesh::MeshWithGroups read_vtu(std::istream& stream, const std::string& name,
                              mesh::OnFault on_fault) {
  return VtuReader(stream, name, on_fault).read();
}

void write_vtu(const mesh::MeshWithGroups& mesh, ElementOrder order, VtuEncoding encoding,
               std::ostream& out) {
  const mesh::ElementMesh elements = mesh::element_mesh(mesh, order);
  VtuWriter writer(encoding, out);
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
         "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n"
      << "    <Piece NumberOfPoints=\"" << elements.node_count() << "\" NumberOfCells=\""
      << elements.element_count() << "\">\n      <Points>\n";
  const auto flat = [](const auto& matrix) {
    return std::vector<typename std::decay_t<decltype(matrix)>::Scalar>(
        matrix.data(), matrix.data() + matrix.size());
  };
  writer.array("Points", "Float64", 3, flat(elements.nodes));
  out << "      </Points>\n      <Cells>\n";
  const int count = elements.element_count(), nodes = elements.nodes_per_element();
  std::vector<std::int64_t> ends(count);
  for (int t = 0; t < count; ++t) ends[t] = std::int64_t{nodes} * (t + 1);
  const std::vector<int> connectivity = flat(elements.elements);
  writer.array("connectivity", "Int64", 1,
               std::vector<std::int64_t>(connectivity.begin(), connectivity.end()));
  writer.array("offsets", "Int64", 1, ends);
  const bool quadratic = order == ElementOrder::kQuadratic;
  writer.array("types", "UInt8", 1,
               std::vector<std::uint8_t>(count, quadratic ? kQuadraticTetrahedron : kTetrahedron));
  out << "      </Cells>\n      <CellData>\n";
  std::vector<double> quality(count);
  for (int t = 0; t < count; ++t) quality[t] = mesh::radius_ratio(mesh.mesh, t);
  writer.array("quality", "Float64", 1, quality);
  for (const auto& [name, group] : mesh.groups) {
    if (group.tetrahedra.empty()) continue;
    std::vector<std::uint8_t> flags(count, 0);
    for (const int t : group.tetrahedra) flags[t] = 1;
    writer.array(kGroup + name, "UInt8", 1, flags);
  }
  out << "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace palpate::mesh_tool
