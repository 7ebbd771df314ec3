#include "tools/lab/uncertainty/distributions.hpp"

#include "rt/config/node.hpp"

namespace palpate::uncertainty {
namespace {

// A deviation beyond these is a mistake of units.
constexpr config::Range kLength{0, 0.1};  // m
constexpr config::Range kAngle{0, 45};    // degrees
constexpr config::Range kShare{0, 0.5};

PoseDeviation read_pose(const config::Node& node) {
  return {node.number({"position", "m", "of each axis"}, kLength, 0),
          node.number({"angle_deg", "degrees", "about each axis"}, kAngle, 0)};
}

/// Of the sensors and of the hand.
void read_sensors(const config::Node& node, Distributions& d) {
  d.hand = read_pose(node.child_or_empty({"hand", "", "pose of the flange that the arm reports"}));
  const config::Node camera = node.child_or_empty({"camera", "", "pose of the camera"});
  d.camera = read_pose(camera);
  d.camera_noise = camera.number(
      {"noise", "", "factor on the published noise of its depth; 0: that of the scene"}, {0, 100},
      0);
  const config::Node payload = node.child_or_empty({"payload", "", "hand's own weight"});
  d.payload_mass = payload.number({"mass", "", "share of the mass"}, kShare, 0);
  d.payload_center = payload.number({"center", "m", "of the centre of mass"}, kLength, 0);
  const config::Node bias = node.child_or_empty({"bias", "", "of the force-torque sensor"});
  d.force_bias = bias.number({"force", "N", "of each axis"}, {0, 100}, 0);
  d.torque_bias = bias.number({"torque", "N m", "of each axis"}, {0, 10}, 0);
  d.force_drift = bias.number({"force_drift", "N", "after 1 s, in every draw"}, {0, 10}, 0);
  d.torque_drift = bias.number({"torque_drift", "N m", "after 1 s, in every draw"}, {0, 1}, 0);
  d.delay = node.child_or_empty({"delay", "", "of the force-torque sensor"})
                .number({"force_torque", "s", "added, half-normal"}, {0, 0.2}, 0);
}

/// Of where the object lies and is held.
void read_places(const config::Node& node, Distributions& d) {
  d.clamp = node.child_or_empty({"clamp", "", "place of the clamp"})
                .number({"position", "m", "of each axis"}, kLength, 0);
  d.grasp = node.child_or_empty({"grasp", "", "place of the hand on the object"})
                .number({"position", "m", "of each axis"}, kLength, 0);
  d.dimensions = node.child_or_empty({"dimensions", "", "edges of the object"})
                     .number({"share", "", "of each edge"}, {0, 0.1}, 0);
  d.gravity_deg = node.child_or_empty({"gravity", "", "direction of gravity"})
                      .number({"angle_deg", "degrees", "about each horizontal axis"}, kAngle, 0);
}

void read_creep(const config::Node& node, Distributions& d) {
  d.creep =
      node.number({"relative_modulus", "", "of a branch of relaxation, half-normal"}, {0, 10}, 0);
  if (d.creep == 0) return;
  d.creep_time = node.numbers({"relaxation_time", "s", "shortest and longest of it, log-uniform"},
                              2, {1e-3, 1e6});
  if (d.creep_time[0] > d.creep_time[1])
    node.fail("relaxation_time", "is not the shortest, then the longest");
}

/// Of the object and of palpated's model of it.
void read_material(const config::Node& node, Distributions& d) {
  const config::Node material = node.child_or_empty({"material", "", "of palpated's model"});
  d.young_modulus = material.number({"log_young_modulus", "", "of log E"}, {0, 3}, 0);
  d.poisson_ratio = material.number({"poisson_ratio", "", "of nu"}, kShare, 0);
  d.density = material.number({"density", "", "share of it"}, {0, 0.45}, 0);
  const config::Node uneven =
      node.child_or_empty({"uneven_stiffness", "", "of the object, from place to place"});
  d.uneven = uneven.number({"deviation", "", "share of the stiffness"}, kShare, 0);
  d.uneven_length =
      uneven.number({"length", "m", "over which it varies"}, {1e-3, 10}, d.uneven_length);
  d.pads_factor =
      node.child_or_empty({"pads", "", "stiffness of the hand's pads"})
          .number({"factor", "", "most, either way, log-uniform"}, {1, 100}, d.pads_factor);
  const config::Node mesh = node.child_or_empty({"mesh", "", "of palpated"});
  d.mesh_factors = mesh.numbers({"cell_factors", "", "of its cells, equally probable"}, -1,
                                {0.1, 4}, d.mesh_factors);
  read_creep(node.child_or_empty({"creep", "", "of the object"}), d);
}

}  // namespace

Distributions read_distributions(const std::filesystem::path& file) {
  const config::Node node = config::Node::load_file(file.string());
  Distributions d;
  d.name = file.stem().string();
  d.about = node.text({"about", "", "what such a set-up is"}, "");
  d.truncated_at = node.number({"truncated_at", "", "deviations at which normal distributions end"},
                               {0.5, 3}, d.truncated_at);
  read_sensors(node, d);
  read_places(node, d);
  read_material(node, d);
  node.check_all_used();
  return d;
}

}  // namespace palpate::uncertainty
