#pragma once

#include <atomic>
#include <functional>
#include <random>

#include "arm.hpp"

namespace palpate::driver {

/// Stand-in for an arm in real time: joints that follow every command within 10 ms, and a sensor
/// that carries a hand. An example of the interface, sufficient for testing a driver.
class SimulatedArm : public Arm {
 public:
  struct Options {
    Joints q;                                                  // rad, at the start
    double mass = 4.8;                                         // kg, mounted on the sensor
    Eigen::Vector3d center_of_mass{0.0015, -0.00065, 0.1137};  // m, in S
    double sensor_z = 0.04;                                    // m, of S along z of E; no rotation
    std::function<double()> clock;                             // s; empty: the machine's
  };

  SimulatedArm(const kinematics::SerialChain& chain, const Options& options);

  int joint_count() const override { return chain_.joint_count(); }
  bool read(ArmState& state) override;
  void command(const Joints& dq) override;

  /// Emulates the stop button; from any thread, also from a signal handler.
  void press_stop(bool pressed) noexcept { stopped_ = pressed; }

 private:
  kinematics::SerialChain chain_;
  Options options_;
  Joints q_, dq_, wanted_;
  double commanded_at_;  // s
  std::atomic<bool> stopped_{false};
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_;
};

}  // namespace palpate::driver
