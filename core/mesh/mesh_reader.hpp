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

/// A mesh file that cannot be read: what() reads "name:line: what is wrong".
class ParseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a reader does where an element names a node that is not there, a coordinate is not finite,
/// or a cell of a volume is no tetrahedron.
enum class OnFault {
  kThrow,  // ParseError
  kKeep,   // for who mends it: index -1, the number as it stands, the cell among the `others`
};

/// A pyramid (5 corners, its tip the last), prism (6) or hexahedron (8), corners in VTK's order.
struct OtherCell {
  int corner_count = 0;
  std::array<int, 8> corners{};
  long number = 0;  // in the file
};

/// Named parts of a mesh, as Gmsh's physical groups and Vega's sets hold them.
struct MeshGroup {
  Eigen::Matrix3Xi triangles;   // node indices; orientation as in the file
  std::vector<int> tetrahedra;  // sorted
  std::vector<int> nodes;       // sorted; of all triangles and tetrahedra
};

struct MeshWithGroups {
  TetrahedralMesh mesh;
  std::map<std::string, MeshGroup> groups;
  EdgeMiddles middles = {};  // of 10-node tetrahedra
  // What the file calls nodes and tetrahedra, for messages; empty where a mesh was made.
  std::vector<long> node_numbers = {};
  std::vector<long> tetrahedron_numbers = {};
  std::vector<OtherCell> others = {};  // OnFault::kKeep only

  /// What the file calls a node or tetrahedron, or the index where no file is known.
  long node_number(int n) const { return node_numbers.empty() ? n : node_numbers[n]; }
  long tetrahedron_number(int t) const {
    return tetrahedron_numbers.empty() ? t : tetrahedron_numbers[t];
  }
};

/// Reads a text line by line into words, with the line number for errors. Empty lines and what
/// follows `comment` are passed over ('\0': no comments).
class LineReader {
 public:
  LineReader(std::istream& stream, const std::string& name, char comment)
      : stream_(stream), name_(name), comment_(comment) {}

  /// Goes to the next line that has words; false at the end.
  bool next();
  /// Same, throws ParseError at the end: `expected` says what should have come.
  void require(const std::string& expected);

  const std::vector<std::string>& words() const { return words_; }
  int size() const { return static_cast<int>(words_.size()); }
  /// The line without white space at its ends.
  const std::string& line() const { return line_; }

  /// Word `i` as a number; ParseError where it is none or absent.
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
