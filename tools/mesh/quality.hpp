#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh/tetrahedral_mesh.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// A quality measure with one value per element.
struct Distribution {
  std::string name;  // "radius ratio"
  std::string key;   // of JSON, including the unit
  std::vector<double> values;

  double least() const;
  double mean() const;
  double most() const;
};

struct Quality {
  int nodes = 0;
  int elements = 0;
  int quadratic_nodes = 0;  // with quadratic elements
  int surface_nodes = 0;
  int surface_triangles = 0;
  int parts = 0;        // that share no node
  int hinge_edges = 0;  // of the surface: other than two triangles
  int hinge_nodes = 0;
  double volume = 0;                                                                 // m^3
  double area = 0;                                                                   // m^2
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  // m
  // Volumes of elements, lengths of edges (each once), then per tetrahedron: smallest and largest
  // dihedral angle in degrees, radius ratio, scaled Jacobian, stiffness relative to that of a
  // regular one.
  std::vector<Distribution> distributions;

  const Distribution& of(const std::string& key) const;
};

/// Precondition: indices are in range and coordinates are finite.
Quality measure_quality(const mesh::TetrahedralMesh& mesh);

std::string text(const Quality& quality);
nlohmann::json to_json(const Quality& quality);

/// Radius ratio before and after in one line, printed after a quality improvement.
std::string compare(const Quality& before, const Quality& after);

/// Histograms of angles, radius ratio, edges and stiffness as a PNG.
void draw_histograms(const Quality& quality, const std::string& title,
                     const std::filesystem::path& png);

}  // namespace palpate::mesh_tool
