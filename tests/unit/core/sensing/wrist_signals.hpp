#pragma once

#include "core/sensing/payload.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Makes `sample` the only message of a stream in this tick.
template <class T, int kCapacity>
void feed(Stream<T, kCapacity>& stream, const T& sample) {
  stream.freshness = Freshness::kNew;
  stream.age = 0;
  stream.latest = sample;
  stream.fresh_count = 1;
  stream.fresh[0] = sample;
}

inline void feed_wrench(Signals& signals, const math::Wrench& wrench) {
  ForceTorque sample;
  sample.F_S = wrench;
  feed(signals.force_torque, sample);
}

/// Motion from the acceleration of the origin and the angular velocity and acceleration of the
/// frame, in W.
inline LoadMotion motion_from_world(const Eigen::Matrix3d& R_WS,
                                    const Eigen::Vector3d& acceleration_W,
                                    const Eigen::Vector3d& angular_velocity_W,
                                    const Eigen::Vector3d& angular_acceleration_W,
                                    const Eigen::Vector3d& gravity_W) {
  LoadMotion motion;
  motion.specific_force = R_WS.transpose() * (acceleration_W - gravity_W);
  motion.angular_velocity = R_WS.transpose() * angular_velocity_W;
  motion.angular_acceleration = R_WS.transpose() * angular_acceleration_W;
  return motion;
}

}  // namespace palpate::sensing
