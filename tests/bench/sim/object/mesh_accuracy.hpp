#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "sim/object/hyperelastic_plant.hpp"
#include "sim/scenes/motion_plan.hpp"

namespace palpate::object {

/// The object of a scene at rest in the hand, and where the hand takes it.
struct MeshCase {
  PlantOptions options;
  std::vector<scenes::Leg> legs;
  bool dented = false;  // by two fingertips, as the scene's fingers do
};

/// Reads a scene. Where fingertips hold the object a pinch by pads over its outer half stands in
/// for them: they would slip and roll, which is no matter of the mesh.
MeshCase read_case(const std::string& scene_file);

/// In equilibrium at one pose of the hand.
struct Equilibrium {
  Eigen::Matrix3Xd moved;  // m, of points on and in the object
  math::Wrench hand;
  bool converged = false;
  std::shared_ptr<const HyperelasticPlant> plant;
};

/// At all poses: moved there from rest, or begun with those of another mesh.
std::vector<Equilibrium> equilibria(const MeshCase& load,
                                    const std::vector<Equilibrium>& start = {});

/// N: what it takes two fingertips to dent the object by 1.5 mm from above and below, near its free
/// end.
double dent_force(const MeshCase& load);

/// Greatest difference over all poses, percent: of the shape over its greatest displacement, of
/// force and torque of the hand over theirs.
std::array<double, 3> differences(const std::vector<Equilibrium>& found,
                                  const std::vector<Equilibrium>& best);

/// Twice the elements along each axis, and shorter still beside clamp and grasp.
PlantOptions refined(const PlantOptions& options);

/// What steps of 1 ms cost as the hand goes to the first pose and back.
struct StepCost {
  double microseconds = 0;  // of this thread's processor time, least of several
  double substeps = 0;
};
StepCost step_cost(const MeshCase& load);

}  // namespace palpate::object
