#pragma once

#include <palpate/biotac_t.hpp>
#include <palpate/compensated_wrench_t.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/config_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/contacts_v1_t.hpp>
#include <palpate/discrepancy_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_command_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/health_v1_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/obstacles_t.hpp>
#include <palpate/picture_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_mesh_v1_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/shape_v1_t.hpp>
#include <palpate/sim_tick_t.hpp>
#include <palpate/tick_done_t.hpp>
#include <palpate/touch_request_t.hpp>
#include <palpate/touch_t.hpp>
#include <palpate/truth_contact_t.hpp>
#include <palpate/truth_touch_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <palpate/unknown_contact_t.hpp>
#include <palpate/world_state_t.hpp>

namespace palpate {

/// Runs `visit` on a fresh message of every type without variable-length parts, in alphabetical
/// order.
template <typename Visit>
void for_each_fixed_size_type(Visit visit) {
  visit(biotac_t{});
  visit(compensated_wrench_t{});
  visit(component_command_t{});
  visit(component_event_t{});
  visit(config_t{});
  visit(contacts_t{});
  visit(contacts_v1_t{});
  visit(discrepancy_t{});
  visit(estimate_t{});
  visit(feature_t{});
  visit(fingertip_t{});
  visit(ft_wrench_t{});
  visit(hand_command_t{});
  visit(hand_state_t{});
  visit(health_t{});
  visit(health_v1_t{});
  visit(imu_t{});
  visit(joint_velocity_command_t{});
  visit(manual_force_t{});
  visit(obstacles_t{});
  visit(robot_state_t{});
  visit(shape_observation_t{});
  visit(shape_target_t{});
  visit(sim_tick_t{});
  visit(tick_done_t{});
  visit(touch_request_t{});
  visit(touch_t{});
  visit(truth_contact_t{});
  visit(truth_touch_t{});
  visit(twist_command_t{});
  visit(unknown_contact_t{});
  visit(world_state_t{});
}

/// Same for the types that hold variable-length arrays, which only the daemon sends.
template <typename Visit>
void for_each_variable_size_type(Visit visit) {
  visit(picture_t{});
  visit(shape_mesh_t{});
  visit(shape_mesh_v1_t{});
  visit(shape_t{});
  visit(shape_v1_t{});
}

}  // namespace palpate
