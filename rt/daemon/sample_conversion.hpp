#pragma once

#include <palpate/biotac_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <palpate/world_state_t.hpp>

#include "core/sensing/signals.hpp"

namespace palpate::daemon {

// Messages of sensors to samples, SI units, in the frames that lcmtypes/*.lcm states. False if a
// number is not finite, beyond what a measurement can be, or inconsistent; `out` may then have
// changed.

bool convert(const ft_wrench_t& m, sensing::ForceTorque& out) noexcept;
bool convert(const imu_t& m, sensing::Inertial& out) noexcept;
bool convert(const robot_state_t& m, sensing::RobotState& out) noexcept;
bool convert(const hand_state_t& m, sensing::HandState& out) noexcept;
bool convert(const manual_force_t& m, sensing::ManualForce& out) noexcept;
bool convert(const world_state_t& m, sensing::ObstacleState& out) noexcept;
bool convert(const biotac_t& m, sensing::BioTac& out) noexcept;
bool convert(const fingertip_t& m, sensing::FingertipContact& out) noexcept;
bool convert(const shape_observation_t& m, sensing::ShapeObservation& out) noexcept;

}  // namespace palpate::daemon
