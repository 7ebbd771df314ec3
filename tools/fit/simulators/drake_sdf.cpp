#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "core/mesh/mesh_writer.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector3d;
using mesh::shortest;

constexpr double kMargin = 1e-6;  // m, between a plane and the nodes that it fixes

/// Nodes at a negative distance do not move.
struct Plane {
  Vector3d point, normal;  // in W, out of the fixed part
  std::vector<int> nodes;  // that it fixes
};

/// Exact zeros, for readable files.
Vector3d without_rounding(const Vector3d& direction) {
  return direction.unaryExpr([](double v) { return std::abs(v) < 1e-12 ? 0.0 : v; });
}

/// The plane across one direction in W that fixes most nodes of the part and no other node.
Plane plane_across(const SoftObject& object, const std::vector<char>& is_fixed,
                   const Vector3d& direction) {
  const Eigen::VectorXd along = object.mesh.nodes.transpose() * direction;
  double bound = std::numeric_limits<double>::infinity();  // nearest node that moves
  for (int node = 0; node < along.size(); ++node) {
    if (is_fixed[node] == 0) bound = std::min(bound, along[node]);
  }
  Plane plane{Vector3d::Zero(), direction, {}};
  double farthest = -std::numeric_limits<double>::infinity();
  for (int node = 0; node < along.size(); ++node) {
    if (!(along[node] < bound - 2 * kMargin)) continue;
    plane.nodes.push_back(node);
    farthest = std::max(farthest, along[node]);
  }
  plane.point = (farthest + kMargin) * direction;
  return plane;
}

/// Planes along the axes of O, which together fix the fixed nodes and no others.
std::vector<Plane> planes(const SoftObject& object) {
  std::vector<char> is_fixed(object.mesh.node_count(), 0);
  for (const int node : object.fixed) is_fixed[node] = 1;
  std::vector<Plane> candidates;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0})
      candidates.push_back(
          plane_across(object, is_fixed, sign * without_rounding(object.X_WO.linear().col(axis))));
  }
  std::set<int> left(object.fixed.begin(), object.fixed.end());
  std::vector<Plane> chosen;
  const auto gain = [&](const Plane& plane) {
    return std::count_if(plane.nodes.begin(), plane.nodes.end(),
                         [&](int node) { return left.count(node) != 0; });
  };
  while (!left.empty()) {
    const auto best =
        std::max_element(candidates.begin(), candidates.end(),
                         [&](const Plane& a, const Plane& b) { return gain(a) < gain(b); });
    if (gain(*best) == 0)
      throw config::Error(object.configuration + ": " + std::to_string(left.size()) + " of " +
                          std::to_string(object.fixed.size()) +
                          " fixed nodes do not lie behind a plane along the axes of O, the only "
                          "ones that a model file of Drake fixes; allowed: another --grasp, or "
                          "--mjcf");
    for (const int node : best->nodes) left.erase(node);
    chosen.push_back(*best);
  }
  return chosen;
}

}  // namespace

void write_drake_sdf(const SoftObject& object, const std::string& mesh_file, std::ostream& out) {
  if (object.materials.size() > 1)
    throw config::Error(object.configuration +
                        ": object.material.regions: a body of Drake has one material; allowed: "
                        "--mjcf");
  const std::vector<Plane> walls = planes(object);
  const elasticity::Material& material = object.materials.front();
  out << "<?xml version=\"1.0\"?>\n<!--\n";
  for (const std::string& line : remarks(object)) out << "  " << line << '\n';
  out << "  Law: linear_corotated, palpate's. Solver: a discrete plant with the contact "
         "approximation kSap, steps of 10 ms.\n  The plant's gravity must be "
      << words(object.gravity_W)
      << " m/s^2.\n  Drake sets every node behind the planes below at rest.\n-->\n"
      << "<sdf version=\"1.7\">\n  <model name=\"object\">\n    <link name=\"object\">\n"
      << "      <collision name=\"collision\">\n        <geometry><mesh><uri>" << mesh_file
      << "</uri></mesh></geometry>\n      </collision>\n      <drake:deformable_properties>\n";
  const auto value = [&](const char* name, const std::string& text) {
    out << "        <drake:" << name << '>' << text << "</drake:" << name << ">\n";
  };
  value("youngs_modulus", shortest(material.young_modulus));
  value("poissons_ratio", shortest(material.poisson_ratio));
  value("mass_density", shortest(material.density));
  value("mass_damping", shortest(object.damping.mass_factor));
  value("stiffness_damping", shortest(object.damping.stiffness_factor));
  value("material_model", "linear_corotated");
  out << "      </drake:deformable_properties>\n";
  for (const Plane& wall : walls)
    out << "      <drake:wall_boundary_condition>\n        <drake:point_on_plane>"
        << words(wall.point) << "</drake:point_on_plane>\n        <drake:outward_normal>"
        << words(wall.normal)
        << "</drake:outward_normal>\n      </drake:wall_boundary_condition>\n";
  out << "    </link>\n  </model>\n</sdf>\n";
}

}  // namespace palpate::fit
