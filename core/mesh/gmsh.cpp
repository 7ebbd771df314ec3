#include "core/mesh/mesh_formats.hpp"

#include <array>
#include <cstdlib>
#include <utility>

#include "core/mesh/gmsh_content.hpp"

namespace palpate::mesh {
namespace {

constexpr int kMostGroups = 100;  // maximum per entity

class GmshReader {
 public:
  GmshReader(std::istream& stream, const std::string& name, OnFault on_fault)
      : stream_(stream), name_(name), reader_(stream, name, '\0'), content_(on_fault) {}

  MeshWithGroups read() {
    while (!is_binary_ && reader_.next()) {
      const std::string section = reader_.words()[0];
      if (section[0] != '$') reader_.fail("'" + section + "' stands outside of any section");
      if (section != "$MeshFormat" && version_ == 0)
        reader_.fail("does not start with $MeshFormat");
      read_section(section);
    }
    if (is_binary_) read_gmsh_binary(stream_, name_, version_, content_);
    if (!content_.has_volume()) reader_.fail("holds no tetrahedra");
    return content_.assemble();
  }

 private:
  void read_section(const std::string& section) {
    const std::string end = "$End" + section.substr(1);
    if (section == "$MeshFormat") {
      read_format();
      if (is_binary_) return;
    } else if (section == "$PhysicalNames") {
      read_gmsh_names(reader_, content_);
    } else if (section == "$Entities") {
      read_entities();
    } else if (section == "$Nodes") {
      version_ == 2 ? read_nodes_2() : read_nodes_4();
    } else if (section == "$Elements") {
      version_ == 2 ? read_elements_2() : read_elements_4();
    } else {
      skip(end);
      return;
    }
    reader_.require(end);
    if (reader_.words()[0] != end) {
      reader_.fail("'" + reader_.line() + "' where " + end + " should stand");
    }
  }

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
    is_binary_ = reader_.integer(1) != 0;
  }

  /// Version 4: physical groups of each entity.
  void read_entities() {
    reader_.require("the numbers of entities");
    std::array<int, 4> counts;
    for (int d = 0; d < 4; ++d) counts[d] = reader_.count(d);
    for (int d = 0; d < 4; ++d) {
      const int box = d == 0 ? 3 : 6;
      for (int i = 0; i < counts[d]; ++i) {
        reader_.require("an entity");
        std::vector<long>& groups = content_.entity_groups[{d, reader_.integer(0)}];
        const int number = reader_.count(1 + box);
        // each element receives its entity's groups, so that long lists of both would multiply
        if (number > kMostGroups) reader_.fail("an entity is in too many physical groups");
        // a negative number: the entity has reversed orientation in that group
        for (int g = 0; g < number; ++g) groups.push_back(std::abs(reader_.integer(2 + box + g)));
      }
    }
  }

  void check(const std::string& error) const {
    if (!error.empty()) reader_.fail(error);
  }

  void add_node(long number, int first_column) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = reader_.number(first_column + i);
    check(content_.add_node(number, p));
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

  /// Element on the present line, whose nodes start at a column.
  void add_element(long type, int first_column, const std::vector<long>& groups) {
    std::vector<long> nodes;
    for (int i = 0; i < gmsh_node_count(type); ++i)
      nodes.push_back(reader_.integer(first_column + i));
    check(content_.add_element(reader_.integer(0), type, nodes, groups));
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
      const GmshContent::Tag entity{reader_.count(0), reader_.integer(1)};
      const long type = reader_.integer(2);
      const int count = reader_.count(3);
      const auto found = content_.entity_groups.find(entity);
      const std::vector<long> groups =
          found == content_.entity_groups.end() ? std::vector<long>() : found->second;
      for (int i = 0; i < count; ++i) {
        reader_.require("an element");
        add_element(type, 1, groups);
      }
    }
  }

  std::istream& stream_;
  const std::string& name_;
  LineReader reader_;
  GmshContent content_;
  int version_ = 0;
  bool is_binary_ = false;
};

}  // namespace

void read_gmsh_names(LineReader& reader, GmshContent& content) {
  reader.require("the number of names");
  const int count = reader.count(0);
  for (int i = 0; i < count; ++i) {
    reader.require("a physical name");
    const GmshContent::Tag tag{reader.count(0), reader.integer(1)};
    const std::string& line = reader.line();
    const std::size_t open = line.find('"'), close = line.rfind('"');
    if (open == close) reader.fail("a physical name must stand in quotes");
    content.names[tag] = line.substr(open + 1, close - open - 1);
  }
}

MeshWithGroups read_gmsh(std::istream& stream, const std::string& name, OnFault on_fault) {
  return GmshReader(stream, name, on_fault).read();
}

}  // namespace palpate::mesh
