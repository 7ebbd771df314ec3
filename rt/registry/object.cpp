#include "rt/registry/object.hpp"

#include <cmath>

#include "core/elasticity/pad_compliance.hpp"
#include "core/estimation/grasp_give.hpp"
#include "core/mesh/report.hpp"
#include "rt/config/material_file.hpp"
#include "rt/config/mesh_file.hpp"

namespace palpate::registry {
namespace {

/// Ten times what a loop can process. Above it factors would exhaust the memory, and objects can be
/// replaced over the network.
constexpr int kMostNodes = 100000;

void check_size(const config::Node& node, const std::string& key, double count) {
  if (count > kMostNodes)
    node.fail(key, "the mesh would have " + std::to_string(std::llround(count)) +
                       " nodes; allowed: at most " + std::to_string(kMostNodes));
}

mesh::TetrahedralMesh read_mesh(const config::Node& object) {
  const config::Node node =
      object.child({"mesh", "", "its tetrahedra; exactly one of box and file"});
  if (node.has("box") == node.has("file"))
    node.fail("", "give exactly one of box and file (an empty `box:` takes away that of the base)");
  mesh::TetrahedralMesh mesh;
  if (node.has("box")) {
    const config::Node box = node.child({"box", "", "a box with a corner in O"});
    const Eigen::Vector3d size = box.vector3({"size", "m", "edges of the box"}, {1e-3, 10});
    const std::vector<double> cells =
        box.numbers({"cells", "", "parts of each edge, six tetrahedra a cell"}, 3, {1, 200});
    check_size(box, "cells", (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
    mesh = mesh::make_box(
        size, {static_cast<int>(cells[0]), static_cast<int>(cells[1]), static_cast<int>(cells[2])});
  } else {
    try {
      mesh = config::load_mesh(
          node.path({"file", "", "TetGen .node or .ele, Gmsh .msh or Vega .veg, in m"}));
    } catch (const std::exception& error) {
      node.fail("file", error.what());
    }
  }
  check_size(node, "", mesh.node_count());
  const mesh::MeshReport report = mesh::check(mesh);
  if (!report.ok()) node.fail("", "the mesh is broken: " + report.text());
  return mesh;
}

std::vector<int> nodes_in(const config::Node& object, const std::string& key,
                          const mesh::ElementMesh& mesh) {
  if (!object.has(key)) return {};
  const config::Node box = object.child(
      {key, "", key == "fixed_box" ? "nodes within it never move" : "nodes within it are held"});
  const Eigen::Vector3d lower = box.vector3({"lower", "m", "lowest corner, in O at rest"});
  const Eigen::Vector3d upper = box.vector3({"upper", "m", "highest corner, in O at rest"});
  std::vector<int> nodes = mesh::nodes_in_box(mesh, lower, upper);
  if (nodes.empty()) object.fail(key, "no node of the mesh lies in this box");
  return nodes;
}

elasticity::GraspRegion read_grasp(const config::Node& object, const Object& solid,
                                   const std::string& prefix) {
  const mesh::ElementMesh& mesh = solid.body.mesh;
  elasticity::GraspRegion grasp;
  grasp.nodes = nodes_in(object, prefix + "grasp_box", mesh);
  if (object.has(prefix + "grasp_at_rest")) {
    grasp.X_OG_rest = object.pose(
        {prefix + "grasp_at_rest", "m", "X_OG at rest; absent: amid the nodes that are held"});
  } else {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int node : grasp.nodes) middle += mesh.nodes.col(node);
    grasp.X_OG_rest.translation() = middle / static_cast<double>(grasp.nodes.size());
  }
  const std::string pads = prefix + "grasp_stiffness";
  if (!object.has(pads)) return grasp;
  const double stiffness =
      object.number({pads, "N/m", "of the pads together; absent: they do not give way"}, {1, 1e9});
  try {
    grasp.compliance = elasticity::pad_compliance(solid.body, grasp, solid.surface, stiffness);
  } catch (const std::invalid_argument& error) {
    object.fail(pads, error.what());
  }
  return grasp;
}

/// Section `material`, overridden by `material_file`, and section `damping`.
void read_material(const config::Node& object, elasticity::Body& body) {
  const config::Node node = config::material_section(object);
  const auto file = config::MaterialFile::read(object);
  std::optional<config::Node> linear, fitted;
  if (file) {
    linear = file->corotational();
    fitted = file->constants();
  }
  body.material.young_modulus = config::material_number(
      node, linear, {"young_modulus", "Pa", "E, of small strain"}, {1, 1e10});
  body.material.poisson_ratio =
      config::material_number(node, linear, {"poisson_ratio", "", "nu"}, {-0.9, 0.4999});
  body.material.density =
      config::material_number(node, fitted, {"density", "kg/m^3", "of mass"}, {0.1, 1e5});
  constexpr config::Range kMass{0, 1e4}, kStiffness{0, 10};
  elasticity::Damping& damping = body.damping;
  if (file) {
    damping.mass_factor = file->constant("mass_damping", kMass, damping.mass_factor);
    damping.stiffness_factor =
        file->constant("stiffness_damping", kStiffness, damping.stiffness_factor);
  }
  const config::Node given =
      object.child_or_empty({"damping", "", "Rayleigh damping; over that of material_file"});
  damping.mass_factor =
      given.number({"mass_factor", "1/s", "share of the mass matrix"}, kMass, damping.mass_factor);
  damping.stiffness_factor =
      given.number({"stiffness_factor", "s", "share of the stiffness matrix"}, kStiffness,
                   damping.stiffness_factor);
}

}  // namespace

Object read_object(const config::Node& root, const Frames& frames) {
  const config::Node node = root.child({"object", "", "the soft object"});
  Object object;
  object.corners = read_mesh(node);
  object.hash = mesh::hash(object.corners);
  elasticity::Body& body = object.body;
  body.mesh = mesh::make_element_mesh(
      object.corners,
      node.choice(
          {"order", "", "of the elements: quadratic ones have 10 nodes and bend as they should"},
          {"linear", "quadratic"}, "quadratic") == "linear"
          ? mesh::ElementOrder::kLinear
          : mesh::ElementOrder::kQuadratic);
  check_size(node, "order", body.mesh.node_count());
  object.surface = mesh::extract_surface(body.mesh);

  read_material(node, body);
  body.fixed_nodes = nodes_in(node, "fixed_box", body.mesh);
  if (node.has("grasp_box")) body.grasps.push_back(read_grasp(node, object, ""));
  if (node.has("second_grasp_box")) {
    if (body.grasps.empty()) node.fail("second_grasp_box", "needs a grasp_box as well");
    body.grasps.push_back(read_grasp(node, object, "second_"));
  }
  if ((body.grasps.size() > 1) != root.has("second_arm"))
    node.fail("second_grasp_box", "goes with a section second_arm, whose hand holds there");
  if (node.flag({"gravity", "", "whether gravity acts on the object"}, true)) {
    body.gravity_O = frames.X_WO.linear().transpose() * frames.gravity_W;
  }
  try {
    body.check();
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    elasticity::GraspRegion& grasp = body.grasps[g];
    grasp.object_compliance = estimation::grasp_give(body, g, grasp.compliance) - grasp.compliance;
  }
  return object;
}

}  // namespace palpate::registry
