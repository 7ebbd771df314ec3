// Complete configurations as read by the daemon: every component is built, or the text is rejected.

#include <filesystem>
#include <fstream>
#include <sstream>

#include "rt/daemon/settings.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {

std::vector<std::string> seeds() {
  const std::string object =
      "object:\n  mesh: {box: {size: [0.2, 0.06, 0.06], cells: [2, 1, 1]}}\n  order: linear\n"
      "  material: {young_modulus: 30e3, poisson_ratio: 0.3, density: 26}\n"
      "  fixed_box: {lower: [0, 0, 0], upper: [0, 0.06, 0.06]}\n"
      "  grasp_box: {lower: [0.2, 0, 0], upper: [0.2, 0.06, 0.06]}\n";
  const std::string frames =
      "frames:\n  object_in_base: {position: [1.36, 0.03, 0.28], rpy_deg: [0, 0, 180]}\n"
      "  sensor_in_flange: {position: [0, 0, 0.04]}\n"
      "  imu_in_flange: {position: [0, 0.055, 0.1], rpy_deg: [0, 0, 90]}\n"
      "  grasp_in_flange: {position: [0, 0, 0.30], rpy_deg: [0, 90, 180]}\n"
      "  gravity_in_base: [0, 0, -9.81]\n";
  const std::string gate =
      "gate:\n  linear_speed: 0.08\n  angular_speed: 0.5\n  force: 20\n  torque: 5\n"
      "  workspace: {lower: [0.35, -0.30, 0.10], upper: [0.80, 0.30, 0.60]}\n";
  const std::string rest =
      "feature: {component: point, rest_points: [[0.1, 0.03, 0.06]]}\n"
      "control: {provider: fem, law: proportional_twist, gain: 1.0}\n";
  return {"loop: {period_ms: 1}\n" + frames + object +
              "sensing:\n  - name: wrist\n    component: ft_newton_euler\n"
              "    payload: {mass: 4.8, center_of_mass: [0.0015, -0.00065, 0.1137]}\n"
              "contact:\n  - name: grasp\n    component: wrench_patch\n    sources: wrist\n"
              "    on_grasp: true\n"
              "estimation: {component: pose_driven}\n"
              "deformation: {component: corotational_quasistatic}\n" +
              rest + gate,
          frames + object +
              "sensing:\n  - {name: wrist, component: ft_tare_only}\n"
              "contact:\n  - {name: grasp, component: wrench_patch, sources: wrist}\n"
              "estimation: {component: force_driven}\n"
              "deformation: {component: linear}\n" +
              rest + gate};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const config::Node root = config::Node::from_text(text, "f");
    const daemon::Settings settings = daemon::read_settings(root);
    const pipeline::Pipeline pipeline(root, settings.loop.period, true);
    fuzz::require(pipeline.object().body.mesh.nodes.allFinite(), "a mesh that is built is finite");
    root.check_all_used();
  } catch (const config::Error& error) {
    fuzz::require(*error.what() != '\0', "an error says something");
  }
  return 0;
}
