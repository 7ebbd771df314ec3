// Components are replaced while the loop runs and, concurrently, one thread builds and destroys
// them and another computes factorisations.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/daemon/daemon.hpp"
#include "tests/stress/rhythm.hpp"

namespace palpate::daemon {
namespace {

const char* kConfiguration = R"(
frames:
  object_in_base: {position: [1.36, 0.03, 0.28], rpy_deg: [0, 0, 180]}
  sensor_in_flange: {position: [0, 0, 0.04]}
  imu_in_flange: {position: [0, 0.055, 0.1], rpy_deg: [0, 0, 90]}
  grasp_in_flange: {position: [0, 0, 0.30], rpy_deg: [0, 90, 180]}
  gravity_in_base: [0, 0, -9.81]
object:
  mesh: {box: {size: [0.2, 0.06, 0.06], cells: [3, 1, 1]}}
  order: linear
  material: {young_modulus: 30e3, poisson_ratio: 0.3, density: 26}
  fixed_box: {lower: [0, 0, 0], upper: [0, 0.06, 0.06]}
  grasp_box: {lower: [0.2, 0, 0], upper: [0.2, 0.06, 0.06]}
sensing:
  - {name: wrist, component: ft_tare_only}
contact:
  - {name: grasp, component: wrench_patch, sources: wrist, on_grasp: true}
estimation: {component: pose_driven}
deformation: {component: corotational_quasistatic}
feature: {component: point, rest_points: [[0.1, 0.03, 0.06]]}
control: {provider: fem, law: proportional_twist, gain: 1.0}
gate:
  linear_speed: 0.08
  angular_speed: 0.5
  force: 20
  torque: 5
  workspace: {lower: [0.35, -0.30, 0.10], upper: [0.80, 0.30, 0.60]}
)";

template <std::size_t N>
void put(std::uint8_t (&field)[N], const char* text) {
  std::memset(field, 0, N);
  std::strncpy(reinterpret_cast<char*>(field), text, N - 1);
}

struct Change {
  const char* slot;
  const char* instance;
  const char* component;
  const char* parameters;
};

TEST(ReplacingStress, ComponentsChangeUnderTheLoop) {
  const auto hub = bus::make_memory_hub();
  const auto control = bus::make_memory_bus(hub), housekeeping = bus::make_memory_bus(hub),
             user = bus::make_memory_bus(hub);
  Daemon daemon(config::Node::from_text(kConfiguration), *control, *housekeeping, Mode::kRealTime,
                7);
  bus::TypedPublisher<component_command_t> commands(*user, "COMPONENT_COMMAND");
  bus::TypedSubscription<component_event_t> events(*user, "COMPONENT_EVENT", 256);
  bus::TypedSubscription<twist_command_t> twists(*user, "TWIST_COMMAND", 256);
  const Change changes[] = {{"deformation", "", "linear", ""},
                            {"control", "", "", "{gain: 0.5}"},
                            {"deformation", "", "corotational_quasistatic", ""},
                            {"object", "", "", "{material: {young_modulus: 40e3}}"},
                            {"control", "", "", "{gain: -1}"},  // rejected
                            {"nowhere", "", "x", ""}};          // rejected

  stress::Rhythm rhythm(1);
  const int wanted = 60;
  int asked = 0, counter = 0, replaced = 0, refused = 0;
  for (std::int64_t tick = 1; replaced + refused < wanted && tick < 4'000'000; ++tick) {
    rhythm.beat();
    if (asked == replaced + refused) {
      const Change& change = changes[asked++ % 6];
      component_command_t command{};
      command.session = 3;
      command.counter = ++counter;
      put(command.event, "replace");
      put(command.slot, change.slot);
      put(command.instance, change.instance);
      put(command.component, change.component);
      put(command.parameters, change.parameters);
      ASSERT_TRUE(commands.publish(command));
    }
    bus::set_time(*hub, tick * 1'000'000);
    daemon.tick({tick * 1'000'000, tick * 1000, 0});
    component_event_t event{};
    twist_command_t twist{};
    std::int64_t arrival_ns = 0;
    while (events.take(event, arrival_ns)) {
      const std::string what(reinterpret_cast<const char*>(event.event));
      // The component replaced last is still being destroyed: retry.
      const std::string reason(reinterpret_cast<const char*>(event.reason));
      if (reason == "another replacement is under way") {
        --asked;
        continue;
      }
      replaced += what == "replaced" ? 1 : 0;
      refused += what == "refused" ? 1 : 0;
    }
    while (twists.take(twist, arrival_ns))
      for (const double number : twist.twist) ASSERT_EQ(number, 0) << "inactive";
  }
  EXPECT_EQ(replaced + refused, wanted);
  EXPECT_EQ(replaced, daemon.replacing().replaced());
  EXPECT_GE(replaced, wanted / 3);
  EXPECT_GE(refused, wanted / 6);
}

}  // namespace
}  // namespace palpate::daemon
