#include <algorithm>

#include "core/mesh/mesh_writer.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace palpate::fit {
namespace {

using mesh::shortest;

constexpr double kTimestep = 2e-3;  // s, at which MuJoCo's solution at rest has converged
// m, unit inertia of a node's body about each axis: without rotation it has no effect.
constexpr double kGyration = 1e-3;

void write_node(const SoftObject& object, int node, double mass, std::ostream& out) {
  const std::string inertia = shortest(mass * kGyration * kGyration);
  out << "    <body name=\"node_" << node << "\" pos=\"" << words(object.mesh.nodes.col(node))
      << "\">\n      <inertial pos=\"0 0 0\" mass=\"" << shortest(mass) << "\" diaginertia=\""
      << inertia << ' ' << inertia << ' ' << inertia << "\"/>\n";
  for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"})
    out << "      <joint type=\"slide\" axis=\"" << axis << "\"/>\n";
  out << "    </body>\n";
}

/// The tetrahedra of one material with the nodes that they need.
void write_flex(const SoftObject& object, int material, const std::vector<char>& is_fixed,
                std::ostream& out) {
  std::vector<int> place(object.mesh.node_count(), -1);
  std::vector<int> nodes, elements;
  for (int t = 0; t < object.mesh.tetrahedron_count(); ++t) {
    if (object.material_of[t] != material) continue;
    for (const int node : object.mesh.tetrahedra.col(t)) {
      if (place[node] < 0) {
        place[node] = static_cast<int>(nodes.size());
        nodes.push_back(node);
      }
      elements.push_back(place[node]);
    }
  }
  const std::string name =
      object.materials.size() == 1 ? "object" : "object_" + std::to_string(material);
  out << "    <flex name=\"" << name << "\" dim=\"3\" radius=\"0.0001\"\n        body=\"";
  for (const int node : nodes)
    out << (is_fixed[node] != 0 ? "world" : "node_" + std::to_string(node)) << ' ';
  out << "\"\n        vertex=\"";
  for (const int node : nodes)
    out << (is_fixed[node] != 0 ? words(object.mesh.nodes.col(node)) : "0 0 0") << ' ';
  out << "\"\n        element=\"";
  for (const int place_of_corner : elements) out << place_of_corner << ' ';
  const elasticity::Material& m = object.materials[material];
  out << "\">\n      <contact selfcollide=\"none\"/>\n      <elasticity young=\""
      << shortest(m.young_modulus) << "\" poisson=\"" << shortest(m.poisson_ratio)
      << "\" damping=\"" << shortest(object.damping.stiffness_factor) << "\"/>\n    </flex>\n";
}

}  // namespace

void write_mjcf(const SoftObject& object, std::ostream& out) {
  out << "<!--\n";
  for (const std::string& line : remarks(object)) out << "  " << line << '\n';
  out << "  Law: Saint Venant-Kirchhoff (MuJoCo's), equal to palpate's co-rotational one for small "
         "strains. Damping proportional to mass is left out.\n  Integrator: discrete (MuJoCo 4), "
         "the only implicit one for this "
         "elasticity.\n-->\n<mujoco model=\"object\">\n  <option integrator=\"discrete\" "
         "timestep=\""
      << shortest(kTimestep) << "\" gravity=\"" << words(object.gravity_W)
      << "\"/>\n  <size memory=\"2G\"/>\n  <worldbody>\n";
  std::vector<char> is_fixed(object.mesh.node_count(), 0);
  for (const int node : object.fixed) is_fixed[node] = 1;
  const Eigen::VectorXd masses = object.masses();
  for (int node = 0; node < object.mesh.node_count(); ++node) {
    if (is_fixed[node] == 0) write_node(object, node, masses[node], out);
  }
  out << "  </worldbody>\n  <deformable>\n";
  for (int m = 0; m < static_cast<int>(object.materials.size()); ++m)
    write_flex(object, m, is_fixed, out);
  out << "  </deformable>\n</mujoco>\n";
}

}  // namespace palpate::fit
