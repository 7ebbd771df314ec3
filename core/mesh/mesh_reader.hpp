#pragma once

#include <array>
#include <istream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/mesh/curved_sides.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// Unreadable mesh file: what() is "name:line: error".
class ParseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Behaviour of a reader if an element refers to a missing node, a coordinate is not finite, or a
/// cell of a volume is not a tetrahedron.
enum class OnFault {
  kThrow,  // ParseError
  kKeep,   // keep for a later repair: index -1, the number as read, the cell among the `others`
};

/// Pyramid (5 corners, apex last), prism (6) or hexahedron (8), corners in VTK's order.
struct OtherCell {
  int corner_count = 0;
  std::array<int, 8> corners{};
  long number = 0;  // number in the file
};

/// Named part of a mesh: a physical group of Gmsh or a set of Vega.
struct MeshGroup {
  Eigen::Matrix3Xi triangles;   // node indices; orientation as in the file
  std::vector<int> tetrahedra;  // sorted
  std::vector<int> nodes;       // sorted; of all triangles and tetrahedra
};

struct MeshWithGroups {
  TetrahedralMesh mesh;
  std::map<std::string, MeshGroup> groups;
  EdgeMiddles middles = {};  // edge midpoints of 10-node tetrahedra
  // Numbers of nodes and tetrahedra in the file, for messages; empty for a generated mesh.
  std::vector<long> node_numbers = {};
  std::vector<long> tetrahedron_numbers = {};
  std::vector<OtherCell> others = {};  // OnFault::kKeep only

  /// Numbers nodes and tetrahedra as a file does that counts both from `first`.
  void number_from(long first);
  /// Number of a node or tetrahedron in the file, or its index if there is no file.
  long node_number(int n) const { return node_numbers.empty() ? n : node_numbers[n]; }
  long tetrahedron_number(int t) const {
    return tetrahedron_numbers.empty() ? t : tetrahedron_numbers[t];
  }
};

/// Reads a text line by line into words, with line numbers for errors. Ignores empty lines and
/// everything after `comment` ('\0': no comments).
class LineReader {
 public:
  LineReader(std::istream& stream, const std::string& name, char comment)
      : stream_(stream), name_(name), comment_(comment) {}

  /// Advances to the next line with words; false at the end.
  bool next();
  /// Same, but throws ParseError at the end; `expected` names the missing item.
  void require(const std::string& expected);

  const std::vector<std::string>& words() const { return words_; }
  int size() const { return static_cast<int>(words_.size()); }
  /// Line without leading and trailing white space.
  const std::string& line() const { return line_; }

  /// Word `i` as a number; throws ParseError if it is missing or not a number.
  double number(int i) const;
  long integer(int i) const;
  /// Word `i` as a count from 0 to 100 million.
  int count(int i) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  const std::string& word(int i) const;

  std::istream& stream_;
  std::string name_;
  char comment_;
  int line_number_ = 0;
  std::string line_;
  std::vector<std::string> words_;
};

}  // namespace palpate::mesh
