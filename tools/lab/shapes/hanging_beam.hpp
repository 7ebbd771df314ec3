#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/lab/shapes/pinhole_camera.hpp"

namespace palpate::shapes {

/// A material point that was found in the picture.
struct BeamCorner {
  std::string name;
  Eigen::Vector3d rest;      // m
  Eigen::Vector2d measured;  // m, x and y where the ray meets the plane of its z at rest
};

/// Part of a beam of one material, by x at rest, m. In a beam of two materials the first part is
/// the one at the clamp.
struct BeamPart {
  std::string material;
  double lower = 0, upper = 0;
};

/// One recorded pose of a beam. Frame: origin in the middle of the section where the bar leaves the
/// clamp, x towards the clamp, y up, z towards the camera; m, rad.
struct BeamCase {
  std::string recording;              // "folder/case"
  std::string name;                   // of the case
  std::vector<BeamPart> parts;        // one or two
  bool is_interface_assumed = false;  // the border of two parts is not stated: middle of the bar
  Eigen::Vector2d centre;             // of the free end block
  double rotation = 0;                // of the block, about z
  double centre_deviation = 0, rotation_deviation = 0, edge_deviation = 0;
  double outline_deviation = 0;  // pixels
  PinholeCamera camera;
  std::vector<BeamCorner> corners;
  Eigen::Matrix2Xd lower_edge;  // of the front face, from the clamp on; empty: not recorded
  Eigen::Matrix2Xd silhouette;  // pixels; empty: not recorded
};

/// Beams of one shape: a bar that leaves a clamp at x = 0 and carries a block at its free end.
struct HangingBeams {
  Eigen::AlignedBox3d bar, block;  // at rest, m
  double density = 0;              // kg/m^3
  Eigen::Vector3d gravity;         // m/s^2
  std::vector<BeamCase> cases;
};

/// Reads the YAML file of a recording and, next to it, CASE_corners.csv and, where they exist,
/// CASE_lower_edge.csv and CASE_silhouette_px.csv, or the files that the case names by `corners`,
/// `lower_edge` and `silhouette`. A case's `material` is a name, or two names separated by a plus
/// sign, that at the clamp first; `interface_rest_x_mm` is their border. Other keys are ignored.
/// `overrides` as of config::Node::load_file().
/// Throws config::Error with file, line, key and allowed range, or recordings::CsvError.
HangingBeams read_hanging_beams(const std::filesystem::path& file,
                                const std::vector<std::string>& overrides = {});

}  // namespace palpate::shapes
