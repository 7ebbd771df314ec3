#include "rt/registry/object.hpp"

#include <algorithm>
#include <cmath>

#include "core/elasticity/pad_compliance.hpp"
#include "core/estimation/grasp_compliance.hpp"
#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/report.hpp"
#include "rt/config/material_file.hpp"
#include "rt/config/mesh_file.hpp"
#include "rt/registry/box.hpp"
#include "rt/registry/regions.hpp"

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

/// Whether nodes of the planes, or midway between two, lie in [lower, upper].
bool has_row_in(double lower, double upper, bool is_quadratic, const std::vector<double>& planes) {
  const auto is_in = [&](double at) { return lower <= at && at <= upper; };
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (is_in(planes[i])) return true;
    if (is_quadratic && i > 0 && is_in(0.5 * (planes[i - 1] + planes[i]))) return true;
  }
  return false;
}

/// Planes of nodes coincide with the bounds of clamp and grasps: a bound between two rows of nodes
/// makes a grasp smaller than it is.
void align_with_boxes(const config::Node& object, bool is_quadratic, mesh::GridPlanes& planes) {
  const std::vector<Box> boxes = boxes_of_parts(object);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double>& along = planes[axis];
    const double near = kSmallShare * (along.back() - along.front());
    constexpr double kRounding = 1e-9;  // m
    std::vector<double> bounds;
    bool all_rows = true;
    const auto add = [&](double bound, double inside) {
      if (bound <= along.front() + near || bound >= along.back() - near) return;
      bounds.push_back(bound);
      const double from = std::min(bound, inside), to = std::max(bound, inside);
      all_rows = all_rows && has_row_in(from - kRounding, to + kRounding, is_quadratic, along);
    };
    for (const Box& box : boxes) {
      add(box.lower[axis], box.lower[axis] + near);
      add(box.upper[axis], box.upper[axis] - near);
    }
    if (!all_rows) mesh::align(bounds, along);
  }
}

mesh::MeshWithGroups read_mesh(const config::Node& object, bool is_quadratic) {
  const config::Node node =
      object.child({"mesh", "", "Tetrahedral mesh; exactly one of box and file"});
  if (node.has("box") == node.has("file"))
    node.fail("",
              "exactly one of box and file is allowed (an empty `box:` removes that of the base)");
  mesh::MeshWithGroups source;
  mesh::TetrahedralMesh& mesh = source.mesh;
  if (node.has("box")) {
    const config::Node box = node.child({"box", "", "Box with a corner in O"});
    const Eigen::Vector3d size = box.vector3({"size", "m", "Edge lengths of the box"}, {1e-3, 10});
    const std::vector<double> cells =
        box.numbers({"cells", "",
                     "Number of cells along each edge, six tetrahedra per cell; cells are "
                     "stretched so that the "
                     "bounds of clamp and grasps lie on rows of nodes"},
                    3, {1, 200});
    check_size(box, "cells", (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
    mesh::GridPlanes planes = mesh::even_planes(
        Eigen::Vector3d::Zero(), size,
        {static_cast<int>(cells[0]), static_cast<int>(cells[1]), static_cast<int>(cells[2])});
    align_with_boxes(object, is_quadratic, planes);
    mesh = mesh::make_grid(planes, mesh::CellCut::kSix);
  } else {
    try {
      source = config::load_mesh_with_groups(
          node.path({"file", "", "Mesh file in m: TetGen .node or .ele, Gmsh .msh or Vega .veg"}));
    } catch (const std::exception& error) {
      node.fail("file", error.what());
    }
  }
  check_size(node, "", mesh.node_count());
  const mesh::MeshReport report = mesh::check(mesh);
  if (!report.ok()) node.fail("", "the mesh is broken: " + report.text());
  return source;
}

elasticity::GraspRegion read_grasp(const config::Node& object, const mesh::MeshWithGroups& source,
                                   const Object& solid, const std::string& prefix,
                                   std::vector<std::string>* remarks) {
  const mesh::ElementMesh& mesh = solid.body.mesh;
  elasticity::GraspRegion grasp;
  grasp.nodes = read_part(object, prefix + "grasp", source, mesh, remarks);
  const std::vector<int> found = read_numbered_nodes(object, prefix + "grasp", mesh);
  if (!found.empty()) grasp.nodes = found;
  std::vector<int> nodes = grasp.nodes;
  std::sort(nodes.begin(), nodes.end());
  check_overlap(object, prefix + "grasp", nodes, "fixed", solid.body.fixed_nodes);
  if (!solid.body.grasps.empty()) {
    std::vector<int> others = solid.body.grasps[0].nodes;
    std::sort(others.begin(), others.end());
    check_overlap(object, prefix + "grasp", nodes, "grasp", others);
  }
  if (object.has(prefix + "grasp_at_rest")) {
    grasp.X_OG_rest = object.pose(
        {prefix + "grasp_at_rest", "m", "X_OG at rest; absent: the centre of the held nodes"});
  } else {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int node : grasp.nodes) middle += mesh.nodes.col(node);
    grasp.X_OG_rest.translation() = middle / static_cast<double>(grasp.nodes.size());
  }
  const std::string pads = prefix + "grasp_stiffness";
  if (!object.has(pads)) return grasp;
  const double stiffness =
      object.number({pads, "N/m", "Stiffness of all pads together; absent: rigid pads"}, {1, 1e9});
  try {
    grasp.compliance = elasticity::pad_compliance(solid.body, grasp, solid.surface, stiffness);
  } catch (const std::invalid_argument& error) {
    object.fail(pads, error.what());
  }
  return grasp;
}

std::optional<Box> read_jaws(const config::Node& object, const char* key) {
  if (!object.has(key)) return {};
  const config::Node node =
      object.child({key, "", "Of a hand that may open: what it holds when it closes"});
  return node.read(box_options("in G"));
}

/// The law that `model` names; null: linear. That of a material file must be the same.
const elasticity::NamedStretchLaw* read_law(const config::Node& material,
                                            const std::optional<config::MaterialFile>& file) {
  std::vector<std::string> names{"linear"};
  for (const auto& law : elasticity::stretch_laws()) names.push_back(law.name);
  const std::string model = material.choice(
      {"model", "",
       "Law of the material, for deformation.component hyperelastic; the others are linear"},
      names, "linear");
  const auto* law = elasticity::find_stretch_law(model);
  if (law != nullptr && file && file->model() != model)
    material.fail("model", model + " is not that of the material file, " + file->model());
  return law;
}

std::optional<double> read_largest_strain(const config::Node& material,
                                          const std::optional<config::MaterialFile>& file) {
  const config::Key key(
      "largest_strain", "",
      "Principal strain, of either sign, up to which the law holds: beyond it the "
      "daemon is degraded. Absent: that of the recordings of material_file, or "
      "not checked");
  if (material.has(key.name)) return material.number(key, {1e-3, 100});
  return file ? file->largest_strain() : std::nullopt;
}

/// Section `material`, overridden by `material_file`, and section `damping`.
void read_material(const config::Node& object, const mesh::MeshWithGroups& source,
                   elasticity::Body& body, std::optional<double>& largest_strain) {
  const config::Node node = config::material_section(object);
  const auto file = config::MaterialFile::read(object);
  const elasticity::NamedStretchLaw* law = read_law(node, file);
  std::optional<config::Node> linear, fitted;
  if (file) {
    fitted = file->constants();
    linear = law == nullptr ? file->corotational() : *fitted;
  }
  body.material.young_modulus = config::material_number(
      node, linear, {"young_modulus", "Pa", "Young's modulus E at small strain"}, {1, 1e10});
  body.material.poisson_ratio = config::material_number(
      node, linear, {"poisson_ratio", "", "Poisson's ratio nu"}, {-0.9, 0.4999});
  body.material.density =
      config::material_number(node, fitted, {"density", "kg/m^3", "Mass density"}, {0.1, 1e5});
  if (law != nullptr) {
    std::vector<double> constants;
    for (const auto& [name, description, start, lower, upper] : law->constants)
      constants.push_back(
          config::material_number(node, fitted, {name, "", description.c_str()}, {lower, upper}));
    body.law = law->make(constants);
  }
  largest_strain = read_largest_strain(node, file);
  read_stiffness_regions(node, source, body);
  constexpr config::Range kMass{0, 1e4}, kStiffness{0, 10};
  elasticity::Damping& damping = body.damping;
  if (file) {
    damping.mass_factor = file->constant("mass_damping", kMass, damping.mass_factor);
    damping.stiffness_factor =
        file->constant("stiffness_damping", kStiffness, damping.stiffness_factor);
  }
  const config::Node given =
      object.child_or_empty({"damping", "", "Rayleigh damping; overrides that of material_file"});
  using elasticity::Damping;
  damping = given.read(
      config::OptionTable<Damping>(damping)
          .number("mass_factor", "1/s", "Factor of the mass matrix", kMass, &Damping::mass_factor)
          .number("stiffness_factor", "s", "Factor of the stiffness matrix", kStiffness,
                  &Damping::stiffness_factor));
}

}  // namespace

Object read_object(const config::Node& root, const Frames& frames,
                   std::vector<std::string>* remarks) {
  const config::Node node = root.child({"object", "", "Soft object"});
  Object object;
  object.obstacles = read_obstacles(root, frames.X_WO);
  const bool is_quadratic =
      node.choice(
          {"order", "", "Order of the elements; quadratic ones have 10 nodes and bend correctly"},
          {"linear", "quadratic"}, "quadratic") == "quadratic";
  const mesh::MeshWithGroups source = read_mesh(node, is_quadratic);
  object.corners = source.mesh;
  object.groups = source.groups;
  object.hash = mesh::hash(object.corners);
  elasticity::Body& body = object.body;
  body.mesh = mesh::make_element_mesh(
      object.corners, is_quadratic ? mesh::ElementOrder::kQuadratic : mesh::ElementOrder::kLinear);
  check_size(node, "order", body.mesh.node_count());
  object.surface = mesh::extract_surface(body.mesh);

  read_material(node, source, body, object.largest_strain);
  body.fixed_nodes = read_part(node, "fixed", source, body.mesh, remarks);
  object.jaws = {read_jaws(node, "grasp_jaws"), read_jaws(node, "second_grasp_jaws")};
  if (has_part(node, "grasp")) body.grasps.push_back(read_grasp(node, source, object, "", remarks));
  if (has_part(node, "second_grasp")) {
    if (body.grasps.empty())
      node.fail("second_grasp_box", "needs a grasp_box or grasp_group as well");
    body.grasps.push_back(read_grasp(node, source, object, "second_", remarks));
  }
  if ((body.grasps.size() > 1) != root.has("second_arm"))
    node.fail("second_grasp_box", "requires a section second_arm, whose hand holds there");
  if (node.flag({"gravity", "", "Gravity on the object"}, true)) {
    body.gravity_O = frames.X_WO.linear().transpose() * frames.gravity_W;
  }
  try {
    body.check();
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    elasticity::GraspRegion& grasp = body.grasps[g];
    grasp.object_compliance =
        estimation::grasp_compliance(body, g, grasp.compliance) - grasp.compliance;
  }
  return object;
}

}  // namespace palpate::registry
