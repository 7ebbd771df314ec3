#include "sim/scenes/simulation.hpp"

#include <stdexcept>
#include <utility>

#include "sim/scenes/soft_box_plant.hpp"

namespace palpate::scenes {
namespace {

constexpr std::int64_t kTruthTicks = 10;   // 100 Hz
constexpr std::int64_t kMeshTicks = 1000;  // 1 Hz
constexpr double kSettlingTime = 60;       // s, simulated, at most

std::vector<Arm> make_arms(const config::Node& node, const Scene& scene, bus::MessageBus& control,
                           const Origin& origin) {
  std::vector<Arm> arms;
  arms.reserve(2);
  arms.emplace_back(node, scene, 0, scene.seed, control, origin.session, origin.start_utime);
  if (scene.second_arm) {
    // The same sensors, but with independent errors.
    const std::uint64_t seed = math::Random(scene.seed, "second_arm").next();
    arms.emplace_back(node, *scene.second_arm, 1, seed, control, origin.session,
                      origin.start_utime);
  }
  return arms;
}

Eigen::Vector3d gravity_in_object(const Scene& scene) {
  if (!scene.object_gravity) return Eigen::Vector3d::Zero();
  return scene.X_WO.linear().transpose() * scene.robot.gravity_W;
}

std::unique_ptr<object::Plant> make_soft_box(const config::Node& node, const Scene& scene,
                                             const std::vector<Arm>& arms) {
  robot::SoftBoxOptions options = *scene.soft_box;
  options.gravity_O = gravity_in_object(scene);
  try {
    auto plant = std::make_unique<SoftBoxPlant>(options, scene.plant.fingertips);
    for (const Arm& arm : arms) arm.fingertips().move(arm.robot(), *plant);
    plant->settle();
    return plant;
  } catch (const std::invalid_argument& error) {
    node.child("object").fail("", error.what());
  }
}

std::unique_ptr<object::Plant> make_plant(const config::Node& node, const Scene& scene,
                                          const std::vector<Arm>& arms) {
  if (scene.soft_box) return make_soft_box(node, scene, arms);
  object::PlantOptions options = scene.plant;
  for (std::size_t i = 0; i < options.grasps.size(); ++i)
    options.grasps[i].X_OG_rest = arms[i].grasp_in_object();
  options.gravity_O = gravity_in_object(scene);
  try {
    auto plant = std::make_unique<object::HyperelasticPlant>(options);
    for (const Arm& arm : arms) arm.fingertips().move(arm.robot(), *plant);
    if (!plant->settle(kSettlingTime).converged)
      throw std::invalid_argument("the object does not come to rest under its weight");
    return plant;
  } catch (const std::invalid_argument& error) {
    node.child("object").fail("", error.what());
  }
}

}  // namespace

Simulation::Simulation(const config::Node& node, bus::MessageBus& control,
                       bus::MessageBus& housekeeping, const Origin& origin, CloudSink clouds)
    : scene_(read_scene(node)),
      origin_(origin),
      arms_(make_arms(node, scene_, control, origin)),
      plant_(make_plant(node, scene_, arms_)),
      pokes_(scene_.pokes),
      slips_(scene_.slips),
      camera_(scene_.camera
                  ? std::make_unique<CameraPublisher>(control, std::move(clouds), scene_, arms_,
                                                      origin.session, origin.start_utime)
                  : nullptr),
      markers_(scene_.markers ? std::make_unique<MarkerPublisher>(
                                    control, scene_, plant(), origin.session, origin.start_utime)
                              : nullptr),
      truth_(housekeeping, *plant_, origin.session) {}

std::vector<math::Pose> Simulation::grasps_in_object() const {
  std::vector<math::Pose> poses;
  for (const Arm& arm : arms_) poses.push_back(arm.grasp_in_object());
  return poses;
}

const object::HyperelasticPlant& Simulation::plant() const {
  const auto* plant = dynamic_cast<const object::HyperelasticPlant*>(plant_.get());
  if (plant == nullptr) throw std::logic_error("the scene's object is not hyperelastic");
  return *plant;
}

/// A scene with cuts has a hyperelastic object.
void Simulation::cut() {
  for (; cuts_done_ < scene_.cuts.size() && scene_.cuts[cuts_done_].at <= time(); ++cuts_done_) {
    auto& plant = dynamic_cast<object::HyperelasticPlant&>(*plant_);
    try {
      plant.cut(scene_.cuts[cuts_done_].box);
    } catch (const std::invalid_argument& error) {
      throw config::Error(std::string("cuts: ") + error.what());
    }
  }
}

void Simulation::step() {
  obey();
  advance();
  publish();
  publish_truth();
}

void Simulation::obey() {
  for (Arm& arm : arms_) arm.obey();
}

void Simulation::advance() {
  for (Arm& arm : arms_) arm.step(tick_, time(), kPeriod, *plant_);
  ++tick_;
  pokes_.apply(time(), *plant_);
  slips_.apply(time(), *plant_);
  cut();
  for (const Arm& arm : arms_) arm.lead(*plant_);
  plant_->step(kPeriod);
  for (Arm& arm : arms_) arm.sample(kPeriodUs * tick_, *plant_);
}

void Simulation::publish() {
  const std::int64_t now_us = kPeriodUs * tick_;
  for (Arm& arm : arms_) arm.publish(now_us);
  if (camera_) camera_->step(now_us, arms_, *plant_);
  if (markers_) markers_->step(now_us, plant());
}

void Simulation::publish_truth() {
  if (tick_ % kTruthTicks == 0) {
    truth_.publish_shape(*plant_, utime());
    truth_.publish_contact(*plant_, grasps_in_object(), utime());
    const FingertipCoupling& fingertips = arms_[0].fingertips();
    if (fingertips.tip_count() > 0) truth_.publish_touch(*plant_, fingertips, utime());
  }
  if (tick_ % kMeshTicks == 1) truth_.publish_mesh(utime());
}

}  // namespace palpate::scenes
