#include "tools/lab/scores/reached_shape.hpp"

#include <sstream>

#include "rt/bus/message_bus.hpp"
#include "sim/scenes/simulation.hpp"
#include "tools/lab/runs/feature_on_points.hpp"

namespace palpate::scores {
namespace {

/// One pose instead of the scene's own motion.
std::string motion_override(const runs::HandMotion& motion) {
  std::ostringstream text;
  const auto put = [&text](const Eigen::Vector3d& v) {
    text << '[' << v.x() << ", " << v.y() << ", " << v.z() << ']';
  };
  text << "motion={start_delay: 0, poses: [{move: 3, hold: 2, translation: ";
  put(motion.translation);
  text << ", rotation_deg: ";
  put(motion.rotation_deg);
  text << "}]}";
  return text.str();
}

}  // namespace

Eigen::VectorXd reached_value(const std::filesystem::path& scene, const runs::ControlTarget& target,
                              const runs::HandMotion& motion) {
  const auto hub = bus::make_memory_hub();
  const auto control = bus::make_memory_bus(hub), housekeeping = bus::make_memory_bus(hub);
  scenes::Simulation simulation(config::Node::load_file(scene.string(), {motion_override(motion)}),
                                *control, *housekeeping);
  while (simulation.time() < simulation.scene().motion->duration()) simulation.step();

  const runs::FeatureOnPoints feature(target);
  Eigen::Matrix3Xd points(3, target.rest_points.size());
  for (int i = 0; i < points.cols(); ++i)
    points.col(i) = simulation.plant().position_at(target.rest_points[i]);
  return feature.value(points);
}

}  // namespace palpate::scores
