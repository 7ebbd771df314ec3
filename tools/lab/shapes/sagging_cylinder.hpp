#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh/mesh_reader.hpp"
#include "tools/lab/shapes/shape_score.hpp"

namespace palpate::shapes {

/// A recorded cylinder, clamped at one end face, with a modulus measured independently of the sag.
/// Its axis is a coordinate axis; the clamped face lies at zero on it.
struct SaggingCylinder {
  std::string name;               // of the folder
  double length = 0, radius = 0;  // m
  int axis = 2;                   // 0 to 2
  Eigen::Vector3d gravity;        // m/s^2
  double density = 0;             // kg/m^3
  double young_modulus = 0;       // Pa
  double mooney = 0;              // fraction of the second constant of Mooney and Rivlin
  Eigen::Vector3d marker;         // m, measured near the free end face's centre
  double marker_deviation = 0;    // m, standard deviation; 0: not stated
};

/// Throws config::Error with file, line, key and allowed range.
SaggingCylinder read_sagging_cylinder(const std::filesystem::path& file);

/// Straight-sided mesh of the cylinder in the recording's frame, with its clamped face as the group
/// `fixed` and the other as `tip`. Its volume is that of the round body.
mesh::MeshWithGroups mesh_of(const SaggingCylinder& cylinder, int rings, int layers);

/// Relative errors of a mesh of the cylinder: volume, and second moment of area about a diameter,
/// averaged over the length.
struct SectionErrors {
  double volume = 0;
  double second_moment = 0;
};
SectionErrors section_errors(const SaggingCylinder& cylinder, const mesh::TetrahedralMesh& mesh);

/// Predictions without a fitted parameter: the co-rotational model on a mesh of 475 nodes and on a
/// finer one, and the hyperelastic one on the latter.
std::vector<ShapeResult> score_sagging_cylinder(const SaggingCylinder& cylinder);

}  // namespace palpate::shapes
