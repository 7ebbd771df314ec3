#include "sim/robot/robot_model.hpp"

#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "sim/robot/inertia_check.hpp"

namespace palpate::robot {
namespace {

/// Number of children with this tag; throws if one has no name.
int count_named(const tinyxml2::XMLElement& root, const char* tag, const std::string& file) {
  int count = 0;
  for (auto* e = root.FirstChildElement(tag); e; e = e->NextSiblingElement(tag), ++count)
    if (!e->Attribute("name") || !*e->Attribute("name"))
      throw std::invalid_argument(file + ":" + std::to_string(e->GetLineNum()) + ": a " + tag +
                                  " without a name");
  return count;
}

math::Pose to_pose(const urdf::Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return math::make_pose(q.normalized().toRotationMatrix(),
                         {pose.position.x, pose.position.y, pose.position.z});
}

/// Returns false for shapes that are not primitives.
bool to_shape(const urdf::Geometry& geometry, VisualShape& shape) {
  switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const auto& d = static_cast<const urdf::Box&>(geometry).dim;
      shape.kind = ShapeKind::kBox;
      shape.size = {d.x, d.y, d.z};
      return true;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& c = static_cast<const urdf::Cylinder&>(geometry);
      shape.kind = ShapeKind::kCylinder;
      shape.size = {c.radius, c.length, 0};
      return true;
    }
    case urdf::Geometry::SPHERE:
      shape.kind = ShapeKind::kSphere;
      shape.size = {static_cast<const urdf::Sphere&>(geometry).radius, 0, 0};
      return true;
    default:
      return false;
  }
}

}  // namespace

RobotModel parse_model(const std::string& text, const std::string& name) {
  const auto fail = [&name](const std::string& what) {
    throw std::invalid_argument(name + ": " + what);
  };
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str()) != tinyxml2::XML_SUCCESS)
    fail(std::string("not a well-formed XML file: ") + document.ErrorStr());
  const tinyxml2::XMLElement* root = document.FirstChildElement("robot");
  if (!root) fail("no <robot> element");
  if (text.find("<xacro:") != std::string::npos) fail("holds xacro macros; expand it first");

  const int links = count_named(*root, "link", name), joints = count_named(*root, "joint", name);
  const urdf::ModelInterfaceSharedPtr urdf = urdf::parseURDF(text);
  if (!urdf) fail("not a URDF file that urdfdom can read");
  if (static_cast<int>(urdf->links_.size()) != links ||
      static_cast<int>(urdf->joints_.size()) != joints) {
    std::ostringstream what;
    what << "holds " << links << " links and " << joints << " joints, but only "
         << urdf->links_.size() << " and " << urdf->joints_.size() << " of them can be read";
    fail(what.str());
  }
  if (links == 0) fail("has no links");

  RobotModel model{text, links, joints, {}, remarks_on_inertia(*urdf)};
  for (const auto& [link_name, link] : urdf->links_)
    for (const auto& visual : link->visual_array) {
      VisualShape shape;
      if (!visual->geometry || !to_shape(*visual->geometry, shape)) continue;
      shape.link = link_name;
      shape.X_LV = to_pose(visual->origin);
      shape.colour.setConstant(0.6);
      if (visual->material) {
        const urdf::Color& c = visual->material->color;
        shape.colour = {c.r, c.g, c.b};
      }
      model.visuals.push_back(shape);
    }
  return model;
}

RobotModel load_model(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument(path + ": cannot be opened");
  std::ostringstream text;
  text << file.rdbuf();
  return parse_model(text.str(), path);
}

}  // namespace palpate::robot
