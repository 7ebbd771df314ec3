#pragma once

#include <Eigen/Core>
#include <filesystem>
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

/// The pale background of the faults: for a mesh of tetrahedra the boundary of the drawable ones,
/// for a surface the drawable triangles.
mesh::TriangleSurface background(const mesh::MeshWithGroups& mesh);
mesh::TriangleSurface background(const mesh::TriangleSurface& surface);

/// Draws a body with its faults to a PNG: the whole on the left, each fault marked by a ball; on
/// the right a close-up of the first of the first kind; one colour per kind, with a legend below.
/// Throws std::runtime_error if no image can be rendered.
void draw_faults(const mesh::TriangleSurface& body, const std::vector<Fault>& faults,
                 const std::string& title, const std::filesystem::path& png);

}  // namespace palpate::mesh_tool
