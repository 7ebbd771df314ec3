#include "rt/registry/urdf_file.hpp"

#include <urdf_parser/urdf_parser.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace palpate::registry {

urdf::ModelInterfaceSharedPtr parse_urdf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument(path + ": cannot be opened");
  std::ostringstream text;
  text << file.rdbuf();
  if (text.str().find("<xacro:") != std::string::npos)
    throw std::invalid_argument(path + ": holds xacro macros; expand it first");
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text.str());
  if (!model || !model->getRoot())
    throw std::invalid_argument(path + ": not a URDF file that urdfdom can read");
  return model;
}

math::Pose to_pose(const urdf::Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return math::make_pose(q.normalized().toRotationMatrix(),
                         {pose.position.x, pose.position.y, pose.position.z});
}

}  // namespace palpate::registry
