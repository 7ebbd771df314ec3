#include "sim/robot/robot_model.hpp"

#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/robot/number_text.hpp"

namespace palpate::robot {
namespace {

/// Largest mass ratio between a body moved by a joint and its lightest neighbour across moving
/// joints; above it, steps of one millisecond are at risk: rounding errors of the heavy body's
/// forces throw the light one about.
constexpr double kMostMassRatio = 1000;

/// Principal moments of the link itself, ascending, kg m^2.
Eigen::Vector3d principal_moments(const urdf::Inertial& of) {
  Eigen::Matrix3d moment;
  moment << of.ixx, of.ixy, of.ixz, of.ixy, of.iyy, of.iyz, of.ixz, of.iyz, of.izz;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

void check_moments(const urdf::Link& link, std::vector<std::string>& remarks) {
  const Eigen::Vector3d moments = principal_moments(*link.inertial);
  const std::string moments_text = "principal moments " + number(moments[0]) + ", " +
                                   number(moments[1]) + " and " + number(moments[2]) + " kg m^2";
  // Tolerance for values rounded to the digits of a file.
  if (moments[0] < 0 || (link.inertial->mass > 0 && moments[0] == 0)) {
    remarks.push_back("link " + link.name + " has " + moments_text + ": all must be above zero");
  } else if (moments[2] > 1.01 * (moments[0] + moments[1])) {
    remarks.push_back("link " + link.name + " has " + moments_text +
                      ": no body has one above the sum of the others");
  }
}

/// The first link of the body to which a link is fixed.
const urdf::Link* body_of(const urdf::Link* link) {
  while (link->parent_joint && link->parent_joint->type == urdf::Joint::FIXED)
    link = link->getParent().get();
  return link;
}

/// Properties of a robot's masses and inertias that would make its simulation unstable or are not
/// physical, one sentence each, naming the links: very different masses of bodies (links joined by
/// fixed joints) at a joint, bodies beyond a joint without mass, moments of inertia that no mass
/// distribution could have.
std::vector<std::string> remarks_on_inertia(const urdf::ModelInterface& model) {
  std::vector<std::string> remarks;
  std::map<const urdf::Link*, double> mass;  // kg, of bodies, by their first link
  for (const auto& [name, link] : model.links_) {
    mass[body_of(link.get())] += link->inertial ? link->inertial->mass : 0;
    if (link->inertial) check_moments(*link, remarks);
  }
  for (const auto& [name, joint] : model.joints_) {
    if (joint->type == urdf::Joint::FIXED) continue;
    const urdf::Link* child = model.getLink(joint->child_link_name).get();
    const urdf::Link* parent = body_of(model.getLink(joint->parent_link_name).get());
    const double moved = mass[child], carrying = mass[parent];
    if (moved <= 0) {
      remarks.push_back("link " + child->name + ", which joint " + name +
                        " moves, weighs nothing: give it a mass and moments");
    } else if (parent->parent_joint && carrying > 0 &&  // a fixed base may have any inertia
               std::max(moved / carrying, carrying / moved) > kMostMassRatio) {
      remarks.push_back("joint " + name + " joins " + parent->name + " of " + number(carrying) +
                        " kg and " + child->name + " of " + number(moved) + " kg: more than " +
                        number(kMostMassRatio) +
                        " times as heavy, which makes steps of 1 ms unstable");
    }
  }
  return remarks;
}

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
