#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "sim/object/hyperelastic_plant.hpp"
#include "sim/scenes/motion_plan.hpp"

namespace palpate::object {

/// The object of a scene at rest in the hand, and the poses of the hand.
struct MeshCase {
  PlantOptions options;
  std::vector<scenes::Leg> legs;
  bool dented = false;  // by two fingertips, as in the scene
};

/// Reads a scene. If fingertips hold the object, they are replaced by a pinch by pads over its
/// outer half: slip and rolling are independent of the mesh.
MeshCase read_case(const std::string& scene_file);

/// In equilibrium at one pose of the hand.
struct Equilibrium {
  Eigen::Matrix3Xd moved;  // m, of points on and in the object
  math::Wrench hand;
  bool converged = false;
  std::shared_ptr<const HyperelasticPlant> plant;
};

/// At all poses: moved there from rest, or started from the shapes of another mesh.
std::vector<Equilibrium> equilibria(const MeshCase& load,
                                    const std::vector<Equilibrium>& start = {});

/// N: force of two fingertips that indent the object by 1.5 mm from above and below, near its free
/// end.
double dent_force(const MeshCase& load);

/// Largest difference over all poses, percent: of the shape relative to its largest displacement,
/// of force and torque of the hand relative to theirs.
std::array<double, 3> differences(const std::vector<Equilibrium>& found,
                                  const std::vector<Equilibrium>& best);

/// Twice the elements along each axis, with even shorter ones next to clamp and grasp.
PlantOptions refined(const PlantOptions& options);

/// Cost of steps of 1 ms as the hand moves to the first pose and back.
struct StepCost {
  double microseconds = 0;  // of this thread's processor time, minimum of several
  double substeps = 0;
};
StepCost step_cost(const MeshCase& load);

}  // namespace palpate::object
