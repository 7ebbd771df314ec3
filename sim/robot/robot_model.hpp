#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::robot {

enum class ShapeKind { kBox, kCylinder, kSphere };

/// Primitive shape of a link, for rendering.
struct VisualShape {
  std::string link;
  ShapeKind kind = ShapeKind::kBox;
  Eigen::Vector3d
      size;  // m. Box: edge lengths; cylinder: radius, length along z, 0; sphere: radius, 0, 0
  math::Pose X_LV;         // pose of the shape's centre in the link's frame
  Eigen::Vector3d colour;  // red, green, blue, 0 to 1
};

/// Contents of an expanded URDF file, validated.
struct RobotModel {
  std::string text;  // of the file
  int link_count = 0;
  int joint_count = 0;
  std::vector<VisualShape> visuals;  // meshes are omitted
  std::vector<std::string> remarks;  // about masses and inertias, which are used nevertheless
};

/// Reads and validates an expanded URDF file. urdfdom returns a model for broken files too, so the
/// links and joints that it parsed are counted against those in the file. Throws
/// std::invalid_argument naming the file and the defect.
RobotModel load_model(const std::string& path);

/// The same for the text of a file; `name` identifies it in messages.
RobotModel parse_model(const std::string& text, const std::string& name);

}  // namespace palpate::robot
