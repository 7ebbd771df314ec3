#include "core/mesh/gmsh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace palpate::mesh {
namespace {

using Tag = std::pair<int, long>;  // dimension, number

// Numbers of Gmsh's element types; the corners come first in both.
bool is_triangle(long type) { return type == 2 || type == 9; }      // 3 or 6 nodes
bool is_tetrahedron(long type) { return type == 4 || type == 11; }  // 4 or 10 nodes
constexpr long kTenNodes = 11;
// Edges of a 10-node tetrahedron in Gmsh's order of their nodes.
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};

constexpr int kMostGroups = 100;  // of an entity

class GmshReader {
 public:
  GmshReader(std::istream& stream, const std::string& name) : reader_(stream, name, '\0') {}

  MeshWithGroups read() {
    while (reader_.next()) {
      const std::string section = reader_.words()[0];
      if (section[0] != '$') reader_.fail("'" + section + "' stands outside of any section");
      if (section != "$MeshFormat" && version_ == 0)
        reader_.fail("does not start with $MeshFormat");
      if (section == "$MeshFormat") {
        read_format();
      } else if (section == "$PhysicalNames") {
        read_names();
      } else if (section == "$Entities") {
        read_entities();
      } else if (section == "$Nodes") {
        version_ == 2 ? read_nodes_2() : read_nodes_4();
      } else if (section == "$Elements") {
        version_ == 2 ? read_elements_2() : read_elements_4();
      } else {
        skip("$End" + section.substr(1));
        continue;
      }
      reader_.require("$End" + section.substr(1));
      if (reader_.words()[0] != "$End" + section.substr(1)) {
        reader_.fail("'" + reader_.line() + "' where $End" + section.substr(1) + " should stand");
      }
    }
    if (tetrahedra_.empty()) reader_.fail("holds no tetrahedra");
    return assemble();
  }

 private:
  struct Element {
    std::array<long, 4> nodes;  // 3 or 4 node numbers of the file
    std::vector<long> groups;   // physical numbers
    std::vector<long> middles;  // of the edges kEdges, of 10-node tetrahedra
  };

  void skip(const std::string& end) {
    do {
      reader_.require(end);
    } while (reader_.words()[0] != end);
  }

  void read_format() {
    reader_.require("the version");
    const double version = reader_.number(0);
    if (version >= 2 && version < 3) {
      version_ = 2;
    } else if (version == 4.1) {
      version_ = 4;
    } else {
      reader_.fail("version " + reader_.words()[0] + " cannot be read; allowed: 2.x, 4.1");
    }
    if (reader_.integer(1) != 0) reader_.fail("the file is binary; save it as ASCII");
  }

  void read_names() {
    reader_.require("the number of names");
    const int count = reader_.count(0);
    for (int i = 0; i < count; ++i) {
      reader_.require("a physical name");
      const Tag tag{reader_.count(0), reader_.integer(1)};
      const std::string& line = reader_.line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open == close) reader_.fail("a physical name must stand in quotes");
      names_[tag] = line.substr(open + 1, close - open - 1);
    }
  }

  /// Version 4: which physical groups each entity is in.
  void read_entities() {
    reader_.require("the numbers of entities");
    std::array<int, 4> counts;
    for (int d = 0; d < 4; ++d) counts[d] = reader_.count(d);
    for (int d = 0; d < 4; ++d) {
      const int box = d == 0 ? 3 : 6;
      for (int i = 0; i < counts[d]; ++i) {
        reader_.require("an entity");
        std::vector<long>& groups = entity_groups_[{d, reader_.integer(0)}];
        const int number = reader_.count(1 + box);
        // Each element gets its entity's groups, so that long lists of both would multiply.
        if (number > kMostGroups) reader_.fail("an entity is in too many physical groups");
        for (int g = 0; g < number; ++g) groups.push_back(reader_.integer(2 + box + g));
      }
    }
  }

  void add_node(long number, int first_column) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = reader_.number(first_column + i);
    if (!p.allFinite()) reader_.fail("a coordinate is not finite");
    if (!nodes_.emplace(number, p).second) {
      reader_.fail("node " + std::to_string(number) + " is given twice");
    }
  }

  void read_nodes_2() {
    reader_.require("the number of nodes");
    const int count = reader_.count(0);
    for (int i = 0; i < count; ++i) {
      reader_.require("a node");
      add_node(reader_.integer(0), 1);
    }
  }

  void read_nodes_4() {
    reader_.require("the numbers of nodes");
    const int blocks = reader_.count(0);
    for (int b = 0; b < blocks; ++b) {
      reader_.require("a block of nodes");
      const int count = reader_.count(3);
      std::vector<long> numbers;
      for (int i = 0; i < count; ++i) {
        reader_.require("a node number");
        numbers.push_back(reader_.integer(0));
      }
      for (const long number : numbers) {
        reader_.require("a node");
        add_node(number, 0);
      }
    }
  }

  long node_number(int column) const {
    const long number = reader_.integer(column);
    if (nodes_.count(number) == 0) reader_.fail("there is no node " + std::to_string(number));
    return number;
  }

  /// The element on the present line, whose nodes start at a column.
  void add_element(long type, int first_column, const std::vector<long>& groups) {
    if (!is_triangle(type) && !is_tetrahedron(type)) return;
    Element element{{}, groups, {}};
    const int corners = is_triangle(type) ? 3 : 4;
    for (int i = 0; i < corners; ++i) element.nodes[i] = node_number(first_column + i);
    for (int i = 0; i < 6 && type == kTenNodes; ++i) {
      element.middles.push_back(node_number(first_column + 4 + i));
    }
    (is_triangle(type) ? triangles_ : tetrahedra_).push_back(std::move(element));
  }

  void read_elements_2() {
    reader_.require("the number of elements");
    const int count = reader_.count(0);
    for (int i = 0; i < count; ++i) {
      reader_.require("an element");
      const int tags = reader_.count(2);
      std::vector<long> groups;
      if (tags > 0 && reader_.integer(3) != 0) groups.push_back(reader_.integer(3));
      add_element(reader_.integer(1), 3 + tags, groups);
    }
  }

  void read_elements_4() {
    reader_.require("the numbers of elements");
    const int blocks = reader_.count(0);
    for (int b = 0; b < blocks; ++b) {
      reader_.require("a block of elements");
      const Tag entity{reader_.count(0), reader_.integer(1)};
      const long type = reader_.integer(2);
      const int count = reader_.count(3);
      const auto found = entity_groups_.find(entity);
      const std::vector<long> groups =
          found == entity_groups_.end() ? std::vector<long>() : found->second;
      for (int i = 0; i < count; ++i) {
        reader_.require("an element");
        add_element(type, 1, groups);
      }
    }
  }

  MeshWithGroups assemble() const {
    MeshWithGroups result;
    std::map<long, int> index;
    for (const Element& element : tetrahedra_) {
      for (const long node : element.nodes) index[node] = 0;
    }
    result.mesh.nodes.resize(3, static_cast<int>(index.size()));
    int next = 0;
    for (auto& [number, node] : index) {
      node = next++;
      result.mesh.nodes.col(node) = nodes_.at(number);
    }

    struct Members {
      std::vector<Eigen::Vector3i> triangles;
      std::vector<int> tetrahedra;
      std::set<int> nodes;
    };
    std::map<std::string, Members> groups;
    const auto name = [this](int dimension, long number) {
      const auto found = names_.find({dimension, number});
      return found == names_.end() ? std::to_string(number) : found->second;
    };
    result.mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra_.size()));
    for (int t = 0; t < result.mesh.tetrahedron_count(); ++t) {
      const Element& element = tetrahedra_[t];
      for (int i = 0; i < 4; ++i) result.mesh.tetrahedra(i, t) = index.at(element.nodes[i]);
      for (std::size_t i = 0; i < element.middles.size(); ++i) {
        const int a = index.at(element.nodes[kEdges[i][0]]),
                  b = index.at(element.nodes[kEdges[i][1]]);
        result.middles[std::minmax(a, b)] = nodes_.at(element.middles[i]);
      }
      for (const long number : element.groups) {
        Members& group = groups[name(3, number)];
        group.tetrahedra.push_back(t);
        for (int i = 0; i < 4; ++i) group.nodes.insert(result.mesh.tetrahedra(i, t));
      }
    }
    for (const Element& element : triangles_) {
      Eigen::Vector3i corners;
      bool inside = true;
      for (int i = 0; i < 3; ++i) {
        const auto found = index.find(element.nodes[i]);
        inside = inside && found != index.end();
        corners[i] = inside ? found->second : -1;
      }
      if (!inside) continue;  // a surface that bounds no tetrahedron
      for (const long number : element.groups) {
        Members& group = groups[name(2, number)];
        group.triangles.push_back(corners);
        group.nodes.insert(corners.begin(), corners.end());
      }
    }
    for (const auto& [group_name, members] : groups) {
      MeshGroup& group = result.groups[group_name];
      group.tetrahedra = members.tetrahedra;
      group.nodes.assign(members.nodes.begin(), members.nodes.end());
      group.triangles.resize(3, static_cast<int>(members.triangles.size()));
      for (int t = 0; t < group.triangles.cols(); ++t)
        group.triangles.col(t) = members.triangles[t];
    }
    return result;
  }

  LineReader reader_;
  int version_ = 0;
  std::map<Tag, std::string> names_;
  std::map<Tag, std::vector<long>> entity_groups_;
  std::map<long, Eigen::Vector3d> nodes_;
  std::vector<Element> triangles_;
  std::vector<Element> tetrahedra_;
};

}  // namespace

MeshWithGroups read_gmsh(std::istream& stream, const std::string& name) {
  return GmshReader(stream, name).read();
}

}  // namespace palpate::mesh
