#include <algorithm>
#include <set>
#include <sstream>

#include "core/mesh/mesh_formats.hpp"

namespace palpate::mesh {
namespace {

/// Replacing every *INCLUDE in the text would lose line numbers, so an included section is read by
/// a separate reader.
class VegaReader {
 public:
  VegaReader(std::istream& stream, const std::string& name, const Includer& include,
             OnFault on_fault)
      : reader_(stream, name, '#'), include_(include), on_fault_(on_fault) {}

  MeshWithGroups read() {
    bool more = reader_.next();
    while (more) {
      const std::string section = reader_.words()[0];
      if (section == "*VERTICES") {
        if (has_nodes_) reader_.fail("*VERTICES comes twice");
        read_section([this](LineReader& r) {
          result_.mesh.nodes = read_tetgen_nodes(r, first_, on_fault_);
        });
        has_nodes_ = true;
        more = reader_.next();
      } else if (section == "*ELEMENTS") {
        read_elements();
        more = reader_.next();
      } else if (section == "*SET") {
        more = read_set();
      } else if (section == "*INCLUDE") {
        reader_.fail("*INCLUDE is only known right below *VERTICES and *ELEMENTS");
      } else {
        more = reader_.next();  // skip materials, regions
      }
    }
    if (!has_nodes_) reader_.fail("there is no *VERTICES");
    if (!has_elements_) reader_.fail("there is no *ELEMENTS");
    result_.number_from(first_);
    return std::move(result_);
  }

 private:
  template <typename Read>
  void read_section(Read read) {
    reader_.require("numbers or *INCLUDE");
    if (reader_.words()[0] != "*INCLUDE") {
      read(reader_);
      return;
    }
    if (reader_.size() < 2) reader_.fail("*INCLUDE needs the name of a file");
    const std::string name = reader_.line().substr(reader_.line().find(reader_.words()[1]));
    std::string text;
    try {
      text = include_(name);
    } catch (const std::exception& error) {
      reader_.fail(error.what());
    }
    std::istringstream stream(text);
    LineReader included(stream, name, '#');
    included.require("a count");
    read(included);
  }

  void read_elements() {
    if (!has_nodes_) reader_.fail("*ELEMENTS come before *VERTICES");
    if (has_elements_) reader_.fail("*ELEMENTS come twice");
    reader_.require("the kind of elements");
    if (reader_.words()[0] != "TET" && reader_.words()[0] != "TETS") {
      reader_.fail("elements are '" + reader_.words()[0] + "'; only TETS can be read");
    }
    read_section([this](LineReader& r) {
      result_.mesh.tetrahedra =
          read_tetgen_elements(r, first_, result_.mesh.node_count(), on_fault_);
    });
    has_elements_ = true;
  }

  /// "*SET name", then comma-separated element numbers; true if another section follows.
  bool read_set() {
    if (!has_elements_) reader_.fail("*SET comes before *ELEMENTS");
    if (reader_.size() < 2) reader_.fail("*SET needs a name");
    const std::string name = reader_.words()[1];
    const TetrahedralMesh& mesh = result_.mesh;
    std::set<int> tetrahedra, nodes;
    bool more = false;
    while ((more = reader_.next()) && reader_.line()[0] != '*') {
      std::string text = reader_.line();
      std::replace(text.begin(), text.end(), ',', ' ');
      std::istringstream numbers(text);
      for (long number = 0; numbers >> number;) {
        const long t = number - first_;
        if (t < 0 || t >= mesh.tetrahedron_count()) {
          reader_.fail("there is no element " + std::to_string(number));
        }
        tetrahedra.insert(static_cast<int>(t));
        for (int i = 0; i < 4; ++i) {
          if (mesh.tetrahedra(i, t) >= 0) nodes.insert(mesh.tetrahedra(i, t));
        }
      }
      if (!numbers.eof()) reader_.fail("a set must hold element numbers");
    }
    MeshGroup& group = result_.groups[name];
    group.tetrahedra.assign(tetrahedra.begin(), tetrahedra.end());
    group.nodes.assign(nodes.begin(), nodes.end());
    return more;
  }

  LineReader reader_;
  const Includer& include_;
  OnFault on_fault_;
  MeshWithGroups result_;
  long first_ = 0;
  bool has_nodes_ = false;
  bool has_elements_ = false;
};

}  // namespace

MeshWithGroups read_vega(std::istream& stream, const std::string& name, const Includer& include,
                         OnFault on_fault) {
  return VegaReader(stream, name, include, on_fault).read();
}

}  // namespace palpate::mesh
