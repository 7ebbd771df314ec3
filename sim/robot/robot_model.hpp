#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::robot {

enum class ShapeKind { kBox, kCylinder, kSphere };

/// A primitive shape of a link, for drawing.
struct VisualShape {
  std::string link;
  ShapeKind kind = ShapeKind::kBox;
  Eigen::Vector3d size;  // m. Box: edges; cylinder: radius, length along z, 0; sphere: radius, 0, 0
  math::Pose X_LV;       // pose of the shape's centre in the link's frame
  Eigen::Vector3d colour;  // red, green, blue, 0 to 1
};

/// What an expanded URDF file says, checked.
struct RobotModel {
  std::string text;  // of the file
  int link_count = 0;
  int joint_count = 0;
  std::vector<VisualShape> visuals;  // meshes are left out
  std::vector<std::string> remarks;  // on masses and inertias, which are taken all the same
};

/// Reads and checks an expanded URDF file. urdfdom returns a model for broken files too, so the
/// links and joints that it understood are counted against those that the file holds. Throws
/// std::invalid_argument, naming the file and what is wrong with it.
RobotModel load_model(const std::string& path);

/// The same for the text of a file; `name` stands for it in messages.
RobotModel parse_model(const std::string& text, const std::string& name);

}  // namespace palpate::robot
