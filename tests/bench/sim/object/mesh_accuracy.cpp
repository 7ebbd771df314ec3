#include "tests/bench/sim/object/mesh_accuracy.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <ctime>
#include <stdexcept>

#include "sim/robot/robot.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenes/scene.hpp"

namespace palpate::object {
namespace {

constexpr double kStep = 1e-3;
constexpr double kInstant = 1e-9;  // s, to move the hand to its pose
constexpr double kTolerance = 1e-6;
constexpr double kSettling = 20;  // s
constexpr double kDent = 1.5e-3;  // m

/// The hand at a fraction of the way to a leg's pose.
math::Pose pose_at(const MeshCase& load, const scenes::Leg& leg, double share) {
  if (load.options.grasps.empty()) return math::Pose::Identity();
  const math::Pose& rest = load.options.grasps[0].X_OG_rest;
  const double angle = leg.rotation.norm();
  const Eigen::Vector3d axis =
      angle > 0 ? Eigen::Vector3d(leg.rotation / angle) : Eigen::Vector3d::UnitX();
  return math::make_pose(Eigen::AngleAxisd(share * angle, axis).toRotationMatrix() * rest.linear(),
                         rest.translation() + share * leg.translation);
}

/// Moves the hand there within `steps` steps.
void go(HyperelasticPlant& plant, const MeshCase& load, const scenes::Leg& leg, double from,
        double to, int steps) {
  const double rate = (to - from) / (kStep * steps);
  const math::Twist velocity{rate * leg.translation, rate * leg.rotation};
  for (int i = 1; i <= steps; ++i)
    plant.step(kStep, pose_at(load, leg, from + (to - from) * i / steps), velocity);
}

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

MeshCase read_case(const std::string& scene_file) {
  const scenes::Scene scene = scenes::read_scene(config::Node::load_file(scene_file));
  if (!scene.motion) throw std::invalid_argument(scene_file + ": the scene has no motion");
  MeshCase load{scene.plant, scene.motion->legs(), !scene.fingertips.empty()};
  robot::Robot robot(robot::load_model(scene.urdf), scene.robot);
  robot.set_joints(scene.initial_joints);
  PlantOptions& options = load.options;
  if (options.grasps.empty()) {
    GraspOptions pinch;
    pinch.patch = {options.origin, options.origin + options.size};
    pinch.patch.lower.x() += 0.5 * options.size.x();  // an element border in all meshes
    pinch.pinch_axis = 2;
    pinch.stiffness = 1e5;
    pinch.damping = 20;
    options.grasps = {pinch};
  }
  options.grasps[0].X_OG_rest = scene.X_WO.inverse() * robot.flange_pose() * scene.X_EG;
  if (scene.object_gravity)
    options.gravity_O = scene.X_WO.linear().transpose() * scene.robot.gravity_W;
  return load;
}

std::vector<Equilibrium> equilibria(const MeshCase& load, const std::vector<Equilibrium>& start) {
  std::vector<Equilibrium> found;
  PlantOptions options = load.options;
  options.viscosity = 0;
  for (const scenes::Leg& leg : load.legs) {
    const auto shared = std::make_shared<HyperelasticPlant>(options);
    HyperelasticPlant& plant = *shared;
    if (start.empty()) {
      go(plant, load, leg, 0, 1, 200);
    } else {
      Eigen::Matrix3Xd positions = plant.rest_positions();
      for (auto node : positions.colwise())
        node = start[found.size()].plant->position_at(Eigen::Vector3d(node));
      plant.step(kInstant, pose_at(load, leg, 1), {});
      plant.set_state(positions, 0 * positions);
    }
    Equilibrium rest;
    rest.plant = shared;
    rest.converged = plant.settle(kSettling, kTolerance).converged;
    rest.hand = plant.hand_wrench();
    rest.moved.resize(3, 20 * 9);
    for (int i = 0; i < rest.moved.cols(); ++i) {
      const Eigen::Array3d at(i / 9 / 19.0, i % 3 / 2.0, i / 3 % 3 / 2.0);
      const Eigen::Vector3d p = options.origin + (at * options.size.array()).matrix();
      rest.moved.col(i) = plant.position_at(p) - p;
    }
    found.push_back(rest);
  }
  return found;
}

double dent_force(const MeshCase& load) {
  PlantOptions options = load.options;
  options.viscosity = 0;
  options.gravity_O.setZero();
  options.grasps.clear();
  options.fingertips.assign(2, FingertipOptions());
  HyperelasticPlant plant(options);
  const double away = options.fingertips[0].radius - kDent;
  Eigen::Vector3d above = options.origin + options.size.cwiseProduct(Eigen::Vector3d(0.8, 0.5, 1));
  Eigen::Vector3d below = above;
  above.z() += away;
  below.z() = options.origin.z() - away;
  plant.move_fingertip(0, above, {});
  plant.move_fingertip(1, below, {});
  plant.settle(kSettling, 1e-4);
  return plant.fingertip(0).touch().force.norm();
}

std::array<double, 3> differences(const std::vector<Equilibrium>& found,
                                  const std::vector<Equilibrium>& best) {
  std::array<double, 3> worst{};
  const auto keep = [](double& most, double difference, double size) {
    most = std::max(most, 100 * difference / size);
  };
  for (std::size_t i = 0; i < best.size(); ++i) {
    keep(worst[0], (found[i].moved - best[i].moved).colwise().norm().maxCoeff(),
         best[i].moved.colwise().norm().maxCoeff());
    keep(worst[1], (found[i].hand.force - best[i].hand.force).norm(), best[i].hand.force.norm());
    keep(worst[2], (found[i].hand.torque - best[i].hand.torque).norm(), best[i].hand.torque.norm());
  }
  return worst;
}

PlantOptions refined(const PlantOptions& options) {
  PlantOptions fine = options;
  for (int& count : fine.elements) count *= 2;
  // Halving each element would halve the growth.
  fine.grading = 1 + 0.75 * (std::max(options.grading, 1.3) - 1);
  return fine;
}

StepCost step_cost(const MeshCase& load) {
  constexpr int kSteps = 60;
  HyperelasticPlant plant(load.options);
  StepCost cost{1e9, 0};
  for (int turn = 0; turn < 6; ++turn) {
    const double start = processor_time();
    go(plant, load, load.legs.front(), turn % 2, 1 - turn % 2, kSteps);
    cost.microseconds = std::min(cost.microseconds, 1e6 * (processor_time() - start) / kSteps);
    cost.substeps = std::max<double>(cost.substeps, plant.substeps());
  }
  return cost;
}

}  // namespace palpate::object
