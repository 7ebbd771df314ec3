#include "sim/robot/inertia_check.hpp"

#include <urdf_model/model.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "sim/robot/number_text.hpp"

namespace palpate::robot {
namespace {

/// Principal moments of the link itself, ascending, kg m^2.
Eigen::Vector3d principal_moments(const urdf::Inertial& of) {
  Eigen::Matrix3d moment;
  moment << of.ixx, of.ixy, of.ixz, of.ixy, of.iyy, of.iyz, of.ixz, of.iyz, of.izz;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

void check_moments(const urdf::Link& link, std::vector<std::string>& remarks) {
  const Eigen::Vector3d moments = principal_moments(*link.inertial);
  const std::string told = "principal moments " + number(moments[0]) + ", " + number(moments[1]) +
                           " and " + number(moments[2]) + " kg m^2";
  // Tolerance for values rounded to the digits of a file.
  if (moments[0] < 0 || (link.inertial->mass > 0 && moments[0] == 0)) {
    remarks.push_back("link " + link.name + " has " + told + ": all must be above zero");
  } else if (moments[2] > 1.01 * (moments[0] + moments[1])) {
    remarks.push_back("link " + link.name + " has " + told +
                      ": no body has one above the sum of the others");
  }
}

/// The first link of the body to which a link is fixed.
const urdf::Link* body_of(const urdf::Link* link) {
  while (link->parent_joint && link->parent_joint->type == urdf::Joint::FIXED)
    link = link->getParent().get();
  return link;
}

}  // namespace

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

}  // namespace palpate::robot
