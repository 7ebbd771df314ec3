#pragma once

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

/// Named parts of a mesh, as Gmsh's physical groups and Vega's sets hold them.
struct MeshGroup {
  Eigen::Matrix3Xi triangles;   // node indices; orientation as in the file
  std::vector<int> tetrahedra;  // sorted
  std::vector<int> nodes;       // sorted; of all triangles and tetrahedra
};

struct MeshWithGroups {
  TetrahedralMesh mesh;
  std::map<std::string, MeshGroup> groups;
  EdgeMiddles middles;  // of 10-node tetrahedra
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
