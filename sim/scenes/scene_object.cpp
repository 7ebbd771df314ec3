#include "sim/scenes/scene_object.hpp"

#include <limits>

#include "rt/config/material_file.hpp"

namespace palpate::scenes {
namespace {

constexpr double kSmallest = 1e-6;

/// Along each edge of a box.
Eigen::Vector3i read_counts(const config::Node& node, const config::Key& key,
                            const config::Range& range) {
  const Eigen::Vector3d counts = node.vector3(key, range);
  if (counts != counts.array().floor().matrix()) node.fail(key.name, "must be whole numbers");
  return counts.cast<int>();
}

/// Both hands have the same pads.
object::GraspOptions read_grasp(const config::Node& node, const char* box) {
  object::GraspOptions grasp;
  grasp.patch = read_box(node.child({box, "", "what the hand holds, in O at rest"}));
  const config::Node pads = node.child_or_empty({"pads", "", "of both hands alike"});
  grasp.stiffness = pads.number({"stiffness", "N/m", "of the pads of a hand together"}, {1, 1e7},
                                grasp.stiffness);
  grasp.damping =
      pads.number({"damping", "N s/m", "of the pads of a hand together"}, {0, 1e4}, grasp.damping);
  grasp.friction =
      pads.number({"friction", "", "of Coulomb, between pads and object"}, {0, 10}, grasp.friction);
  if (pads.has("grip"))
    grasp.grip = pads.number(
        {"grip", "N", "with which the pads press; absent: the object cannot slip"}, {0, 1e4});
  if (pads.has("pinch_axis")) {
    const std::string axis =
        pads.choice({"pinch_axis", "", "of O, along which they press"}, {"x", "y", "z"});
    grasp.pinch_axis = axis[0] - 'x';
  }
  if (node.has("jaws")) {
    const config::Node jaws = node.child(
        {"jaws", "", "of hands that can open: where they hold the surface once they close, in G"});
    grasp.jaws = read_box(jaws);
    grasp.open_at_rest = jaws.flag({"open_at_rest", "", "whether they begin open"}, false);
  }
  return grasp;
}

/// The result of palpate-fit, as far as the plant can represent it: Young's modulus and Poisson's
/// ratio at small strain, one Maxwell branch, and damping, whose stiffness-proportional part
/// becomes the viscosity that is equally strong in shear.
void take_fitted(const config::Node& object, const config::Node& material,
                 const config::MaterialFile& file, object::PlantOptions& plant) {
  const std::string model = file.model();
  if (model != "linear" && model != "neo_hookean")
    object.fail("material_file",
                "its model is " + model +
                    ", but the simulator's object is neo_hookean; allowed: linear, "
                    "neo_hookean: fit the recordings with one of them");
  const double E = config::material_number(material, file.constants(), "young_modulus", {1, 1e9});
  const double nu = config::material_number(material, file.constants(), "poisson_ratio", {0, 0.49});
  plant.mass_damping = file.constant("mass_damping", {0, 1e4}, plant.mass_damping);
  plant.viscosity = (file.constant("stiffness_damping", {0, 10}, 0) * E +
                     file.constant("viscosity", {0, 1e9}, 0)) /
                    (2 * (1 + nu));
  if (file.constants().has("relaxation_ratio"))
    plant.maxwell.push_back({file.constant("relaxation_ratio", {1e-6, 1e3}, 0),
                             file.constant("relaxation_time", {1e-6, 1e6}, 0)});
}

double read_region_modulus(const config::Node& region, double young_modulus) {
  if (!region.has("factor"))
    return region.number({"young_modulus", "Pa", "in the box; or factor"}, {1, 1e9});
  if (region.has("young_modulus"))
    region.fail("factor", "given together with young_modulus; allowed: one of them");
  return young_modulus * region.number({"factor", "", "on the modulus in the box"}, {1e-3, 1e3});
}

/// Section `material`, overridden by `material_file`.
void read_material(const config::Node& object, object::PlantOptions& plant) {
  const config::Node material = config::material_section(object);
  const auto file = config::MaterialFile::read(object);
  std::optional<config::Node> fitted;
  if (file) {
    take_fitted(object, material, *file, plant);
    fitted = file->constants();
  }
  plant.young_modulus = config::material_number(
      material, fitted, {"young_modulus", "Pa", "E, of small strain"}, {1, 1e9});
  plant.poisson_ratio =
      config::material_number(material, fitted, {"poisson_ratio", "", "nu"}, {0, 0.49});
  plant.density =
      config::material_number(material, fitted, {"density", "kg/m^3", "of mass"}, {1, 2e4});
  for (const config::Node& item : material.list({"maxwell", "", "branches of relaxation"})) {
    plant.maxwell.push_back(
        {item.number({"relative_modulus", "", "of the branch, over the relaxed one"}, {1e-6, 1e3}),
         item.number({"relaxation_time", "s", "of the branch"}, {1e-6, 1e6})});
  }
  if (material.has("yield")) {
    const config::Node yield =
        material.child({"yield", "", "plastic flow of von Mises; absent: none"});
    plant.yield = object::Yield{
        yield.number({"stress", "Pa", "at which it begins"}, {1, 1e9}),
        yield.number({"hardening", "Pa", "of the yield stress by plastic strain"}, {0, 1e9}, 0)};
  }
  if (material.has("regions")) {
    for (const config::Node& item : material.list({"regions", "", "boxes of another stiffness"})) {
      plant.regions.push_back({read_box(item.child({"box", "", "where, in O"})),
                               read_region_modulus(item, plant.young_modulus)});
    }
  }
}

object::StiffnessFieldOptions read_stiffness_field(const config::Node& node) {
  object::StiffnessFieldOptions field;
  field.deviation = node.number(
      {"deviation", "", "standard deviation of log E, which stays within two of them"}, {0, 1});
  field.length = node.number({"length", "m", "over which the correlation falls to exp(-1/2)"},
                             {1e-3, 100}, field.length);
  constexpr int kMostSeed = std::numeric_limits<int>::max();
  field.seed = node.integer({"seed", "", "of the field"}, {0, kMostSeed}, 1);
  return field;
}

object::ClampPads read_clamp_pads(const config::Node& node) {
  object::ClampPads pads;
  pads.stiffness = node.number({"stiffness", "N/m", "of the springs of the clamp together"},
                               {1, 1e7}, pads.stiffness);
  pads.damping = node.number({"damping", "N s/m", "of the dampers of the clamp together"}, {0, 1e4},
                             pads.damping);
  return pads;
}

/// Stiffnesses are those of DART's springs, not of a material.
robot::SoftBoxOptions read_soft_box(const config::Node& node) {
  robot::SoftBoxOptions box;
  box.size = node.vector3({"size", "m", "edges of the box"}, {kSmallest, 100});
  box.vertices = read_counts(node, {"vertices", "", "point masses along each edge"}, {3, 200});
  const config::Node material = node.child({"material", "", "of the springs of DART"});
  box.mass = material.number({"density", "kg/m^3", "of mass"}, {1, 2e4}) * box.size.prod();
  box.vertex_stiffness = material.number(
      {"vertex_stiffness", "N/m", "that holds each point mass at its place"}, {1e-3, 1e6});
  box.edge_stiffness =
      material.number({"edge_stiffness", "N/m", "of the edges between them"}, {0, 1e6});
  box.damping =
      node.number({"damping", "", "of the point masses, as DART takes it"}, {0, 1e3}, box.damping);
  box.friction =
      node.number({"friction", "", "of Coulomb, against fingertips"}, {0, 10}, box.friction);
  return box;
}

}  // namespace

object::Box read_box(const config::Node& node) {
  return {node.vector3({"lower", "m", "lowest corner"}),
          node.vector3({"upper", "m", "highest corner"})};
}

void read_object(const config::Node& node, Scene& scene) {
  object::PlantOptions& plant = scene.plant;
  plant.size = node.vector3({"size", "m", "edges of the object, a box with a corner in O"},
                            {kSmallest, 100});
  if (node.choice({"kind", "", "the Neo-Hookean plant, or the SoftBodyNode of DART"},
                  {"hyperelastic", "dart_soft"}, "hyperelastic") == "dart_soft") {
    scene.soft_box = read_soft_box(node);
    scene.X_WO = node.pose({"pose", "m", "X_WO"});
    scene.object_gravity = node.flag({"gravity", "", "whether gravity acts on the object"}, true);
    return;
  }
  Eigen::Vector3i::Map(plant.elements.data()) =
      read_counts(node, {"elements", "", "hexahedra with 27 nodes along each edge"}, {1, 200});
  plant.grading = node.number(
      {"grading", "",
       "growth of the lengths of elements away from where the object is held; 1: all are equal"},
      {1, 3}, plant.grading);
  read_material(node, plant);
  plant.mass_damping = node.number({"damping", "1/s", "by mass"}, {0, 1e4}, plant.mass_damping);
  plant.viscosity =
      node.number({"viscosity", "Pa s", "of the material, in shear"}, {0, 1e6}, plant.viscosity);
  scene.X_WO = node.pose({"pose", "m", "X_WO"});
  if (node.has("grasp_box")) plant.grasps = {read_grasp(node, "grasp_box")};
  if (node.has("second_grasp_box")) {
    if (plant.grasps.empty()) node.fail("second_grasp_box", "needs a grasp_box as well");
    plant.grasps.push_back(read_grasp(node, "second_grasp_box"));
  }
  // An object that hands hold needs no rig.
  if (node.has("clamp_box") || plant.grasps.empty())
    plant.clamp = read_box(node.child({"clamp_box", "", "what a rig holds fast"}));
  if (node.has("clamp_pads")) {
    if (!plant.clamp) node.fail("clamp_pads", "needs a clamp_box");
    plant.clamp_pads = read_clamp_pads(
        node.child({"clamp_pads", "", "springs between rig and object; absent: it is fixed"}));
  }
  if (node.has("stiffness_field"))
    plant.stiffness_field = read_stiffness_field(node.child(
        {"stiffness_field", "", "smooth random variation of Young's modulus; absent: none"}));
  scene.object_gravity = node.flag({"gravity", "", "whether gravity acts on the object"}, true);
}

}  // namespace palpate::scenes
