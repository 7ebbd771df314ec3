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
  kError,    // the mechanics cannot be computed
  kWarning,  // suspicious, but usable
};

/// One class of fault with all its locations, for a message and for an image.
struct Fault {
  std::string kind;  // identifier for programs: "inverted"
  std::string text;  // readable: "tetrahedra turned inside out"
  Severity severity = Severity::kError;
  std::vector<long> numbers;            // in the file, of elements, nodes or triangles
  std::vector<Eigen::Matrix3Xd> faces;  // 3 x 3 each: triangles to be shown, m
  std::vector<Eigen::Vector3d> points;  // to be marked
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> lines;
};

/// All faults of a mesh of tetrahedra. In addition to mesh::check(): parts joined only by a hinge,
/// cells that are not tetrahedra, slivers (radius ratio below 0.02), sizes that suggest wrong
/// units.
std::vector<Fault> find_faults(const mesh::MeshWithGroups& mesh);

/// The same for a surface that is to bound a body.
std::vector<Fault> find_faults(const mesh::TriangleSurface& surface);

bool has_errors(const std::vector<Fault>& faults);

/// "error: tetrahedra turned inside out: 2 (17, 18)", one line each; the first 20 indices.
std::string text(const std::vector<Fault>& faults);

nlohmann::json to_json(const std::vector<Fault>& faults);

/// Up to 20 indices in the file; items that are not in it (negative) are "new".
std::string list_numbers(const std::vector<long>& numbers);

/// Warns if a body is much larger or smaller than anything that a hand can hold.
void add_size_fault(const Eigen::Matrix3Xd& points, std::vector<Fault>& faults);

}  // namespace palpate::mesh_tool
