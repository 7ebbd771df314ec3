#include "rt/registry/arm_inertia.hpp"

#include <algorithm>
#include <stdexcept>

#include "rt/registry/urdf_file.hpp"

namespace palpate::registry {
namespace {

using kinematics::BodyInertia;
using LinkPath = std::vector<urdf::LinkConstSharedPtr>;

/// Of the link alone, in its frame.
BodyInertia inertia_of(const urdf::Link& link) {
  BodyInertia about_center;
  if (!link.inertial) return about_center;
  const urdf::Inertial& i = *link.inertial;
  if (!(i.mass > 0))
    throw std::invalid_argument("link " + link.name + ": mass: " + std::to_string(i.mass) +
                                "; allowed: above 0");
  about_center.mass = i.mass;
  about_center.rotational << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  return BodyInertia::moved(to_pose(i.origin), about_center);
}

/// Adds the link at X_AL and everything beyond it that is not beyond a link of `ends`, which are
/// left out themselves.
void add_branch(const urdf::Link& link, const math::Pose& X_AL, const LinkPath& ends,
                BodyInertia& sum) {
  sum += BodyInertia::moved(X_AL, inertia_of(link));
  for (const auto& child : link.child_links) {
    if (std::find(ends.begin(), ends.end(), child) != ends.end()) continue;
    const urdf::Joint& joint = *child->parent_joint;
    add_branch(*child, X_AL * to_pose(joint.parent_to_joint_origin_transform), ends, sum);
  }
}

}  // namespace

ArmInertia read_inertia(const std::string& path, const std::string& flange) {
  const urdf::ModelInterfaceSharedPtr model = parse_urdf(path);
  const urdf::LinkConstSharedPtr end = model->getLink(flange);
  if (!end) throw std::invalid_argument(path + ": has no link '" + flange + "'");
  LinkPath moved;  // by a joint of the arm, from the base on
  for (urdf::LinkConstSharedPtr link = end; link->parent_joint; link = link->getParent())
    if (link->parent_joint->type != urdf::Joint::FIXED) moved.insert(moved.begin(), link);
  LinkPath ends = moved;
  for (const auto& child : end->child_links) ends.push_back(child);
  try {
    ArmInertia inertia;
    for (const auto& link : moved) {
      inertia.links.emplace_back();
      add_branch(*link, math::Pose::Identity(), ends, inertia.links.back());
    }
    for (const auto& child : end->child_links)
      add_branch(*child, to_pose(child->parent_joint->parent_to_joint_origin_transform), {},
                 inertia.load);
    return inertia;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
}

}  // namespace palpate::registry
