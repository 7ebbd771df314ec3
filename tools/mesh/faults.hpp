#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

enum class Severity {
  kError,    // mechanics cannot be computed on it
  kWarning,  // looks wrong, but can be used
};

/// One class of fault with every place where it is, for a message and for a picture.
struct Fault {
  std::string kind;  // a word for programs: "inverted"
  std::string text;  // for people: "tetrahedra turned inside out"
  Severity severity = Severity::kError;
  std::vector<long> numbers;            // in the file, of elements, nodes or triangles
  std::vector<Eigen::Matrix3Xd> faces;  // 3 x 3 each: triangles to be shown, m
  std::vector<Eigen::Vector3d> points;  // to be marked
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> lines;
};

/// All that is wrong with a mesh of tetrahedra. Beside what mesh::check() finds: parts that hang on
/// a hinge, cells that are no tetrahedra, slivers (radius ratio below 0.02), sizes that look like
/// wrong units.
std::vector<Fault> find_faults(const mesh::MeshWithGroups& mesh);

/// The same of a surface that is to bound a body.
std::vector<Fault> find_faults(const mesh::TriangleSurface& surface);

bool has_errors(const std::vector<Fault>& faults);

/// "error: tetrahedra turned inside out: 2 (17, 18)", a line each; the first 20 numbers.
std::string text(const std::vector<Fault>& faults);

nlohmann::json to_json(const std::vector<Fault>& faults);

}  // namespace palpate::mesh_tool
