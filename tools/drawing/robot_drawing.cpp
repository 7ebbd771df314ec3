#include "tools/drawing/robot_drawing.hpp"

#include <cmath>
#include <set>
#include <stdexcept>

#include "rt/registry/urdf_file.hpp"

namespace palpate::drawing {
namespace {

/// Returns false for shapes that are not primitives.
bool read_shape(const urdf::Visual& visual, LinkShape& shape) {
  if (!visual.geometry) return false;
  switch (visual.geometry->type) {
    case urdf::Geometry::BOX: {
      const auto& size = static_cast<const urdf::Box&>(*visual.geometry).dim;
      shape.kind = "box";
      shape.size = {size.x, size.y, size.z};
      break;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(*visual.geometry);
      shape.kind = "cylinder";
      shape.size = {cylinder.radius, cylinder.length, 0};
      break;
    }
    case urdf::Geometry::SPHERE:
      shape.kind = "sphere";
      shape.size = {static_cast<const urdf::Sphere&>(*visual.geometry).radius, 0, 0};
      break;
    default:
      return false;
  }
  shape.X_LV = registry::to_pose(visual.origin);
  shape.colour.setConstant(0.6);
  if (visual.material) {
    const urdf::Color& c = visual.material->color;
    shape.colour = {c.r, c.g, c.b};
  }
  return true;
}

}  // namespace

RobotDrawing::RobotDrawing(const std::string& path, const std::string& flange) {
  const urdf::ModelInterfaceSharedPtr model = registry::parse_urdf(path);
  std::set<std::string> arm;  // links from the root to the flange
  urdf::LinkConstSharedPtr link = model->getLink(flange);
  if (!link) throw std::invalid_argument(path + ": has no link '" + flange + "'");
  for (; link; link = link->getParent()) arm.insert(link->name);

  std::vector<std::pair<urdf::LinkConstSharedPtr, int>> waiting{{model->getRoot(), -1}};
  while (!waiting.empty()) {
    const auto [from, parent] = waiting.back();
    waiting.pop_back();
    Link made;
    made.parent = parent;
    if (from->parent_joint) {
      const urdf::Joint& joint = *from->parent_joint;
      made.X_PL = registry::to_pose(joint.parent_to_joint_origin_transform);
      const bool turns =
          joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
      if (turns || joint.type == urdf::Joint::PRISMATIC) {
        made.motion = turns ? Motion::kTurns : Motion::kSlides;
        const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
        if (!(axis.norm() > 1e-6))
          throw std::invalid_argument(path + ": joint " + joint.name + " has no axis");
        made.axis = axis.normalized();
        made.of_arm = arm.count(from->name) > 0;
        made.joint = made.of_arm ? arm_joints_++ : hand_joints_++;
      }
    }
    for (const auto& visual : from->visual_array) {
      LinkShape shape;
      if (!read_shape(*visual, shape)) continue;
      if (made.drawn < 0) made.drawn = drawn_links_++;
      shape.link = made.drawn;
      shapes_.push_back(shape);
    }
    const int number = static_cast<int>(links_.size());
    links_.push_back(made);
    // Depth first, the first child first.
    for (auto child = from->child_links.rbegin(); child != from->child_links.rend(); ++child)
      waiting.emplace_back(*child, number);
  }
}

void RobotDrawing::place(const math::Pose& X_AW, const double* arm_q, int arm_count,
                         const double* hand_q, int hand_count, std::vector<float>& out) const {
  std::vector<math::Pose> poses(links_.size());
  const std::size_t first = out.size();
  out.resize(first + static_cast<std::size_t>(7) * drawn_links_);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    math::Pose& X_AL = poses[i];
    X_AL = (link.parent < 0 ? X_AW : poses[static_cast<std::size_t>(link.parent)]) * link.X_PL;
    if (link.joint >= 0 && link.joint < (link.of_arm ? arm_count : hand_count)) {
      const double q = (link.of_arm ? arm_q : hand_q)[link.joint];
      if (link.motion == Motion::kTurns)
        X_AL.rotate(Eigen::AngleAxisd(q, link.axis));
      else
        X_AL.translate(q * link.axis);
    }
    if (link.drawn < 0) continue;
    float* at = out.data() + first + static_cast<std::size_t>(7) * link.drawn;
    Eigen::Vector3f::Map(at) = X_AL.translation().cast<float>();
    const Eigen::Quaternionf quaternion(Eigen::Quaterniond(X_AL.linear()));
    Eigen::Vector4f::Map(at + 3) = quaternion.coeffs();
  }
}

}  // namespace palpate::drawing
