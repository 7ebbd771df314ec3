#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/tools/bridge/common/memory_stream.hpp"
#include "tools/bridge/franka/datagrams.hpp"
#include "tools/bridge/franka/follower.hpp"
#include "tools/driver/arm.hpp"

namespace palpate::franka_bridge {

/// What a Franka arm and its control do, in virtual time: the server side of the FCI, version 10,
/// which refuses everything that the protocol does not allow; seven joints; the reflexes that
/// joint velocities can cause. The members are faults.
class MockArm {
 public:
  struct Datagram {
    std::int64_t arrival_ns = 0;
    std::vector<std::uint8_t> bytes;
  };
  struct Network {
    bridge::Pipe tcp;
    std::deque<Datagram> to_client, to_server;
    std::uint16_t client_port = 0;  // where states go
  };
  static constexpr double kBrakes = 30;  // rad/s^2, of its own stops
  static constexpr int kStartUp = 5;     // ms until a motion runs
  static constexpr int kMostLost = 20;   // commands in a row

  explicit MockArm(const driver::Joints& q);

  std::unique_ptr<bridge::Stream> stream();
  std::unique_ptr<Datagrams> datagrams();
  Network& network() { return network_; }

  /// Once per ms.
  void step(std::int64_t now_ns);
  /// As by switching it off and on.
  void restart();
  /// A contact with the surroundings.
  void collide();
  /// A person releases the user stop and clears the error.
  void release();

  const driver::Joints& q() const { return q_; }
  double speed() const { return dq_.lpNorm<Eigen::Infinity>(); }  // rad/s, of the fastest joint
  const std::string& violation() const { return violation_; }     // of the protocol, by the client
  int motions() const { return motions_; }                        // begun
  int ended() const { return ended_; }                            // of them regularly
  int commands() const { return commands_; }
  int reflexes() const { return reflexes_; }
  RobotMode mode() const { return mode_; }

  bool is_absent = false;     // the network is cut
  bool is_mute = false;       // sends no states
  bool is_deaf = false;       // receives no commands
  bool has_nan = false;       // in its positions
  bool is_cut_short = false;  // sends states of another size
  bool is_taken = false;      // another program is connected
  bool is_moved_by_others = false;
  bool is_user_stopped = false;
  std::uint16_t version = kFciVersion;
  std::int64_t delay_ns = 0;       // of what it sends
  std::uint8_t refuses_moves = 0;  // status that it answers
  std::array<bool, kErrors> extra_errors{};
  Seven tau_J{}, tau_ext{};
  std::array<double, 6> F_K{};
  std::array<double, 16> X_FE, X_EK;
  double end_effector = 0, load = 0;  // kg
  std::string urdf;                   // answered to kGetRobotModel

 private:
  void serve();
  void handle(const Header& header, const std::vector<std::uint8_t>& payload);
  void answer(std::uint32_t request, std::uint32_t number,
              const std::vector<std::uint8_t>& payload);
  void begin_motion(std::uint32_t number);
  void end_motion(RobotMode mode, std::uint8_t status);
  void reflex(std::size_t error);
  void take_commands();
  void obey(const Seven& dq, bool is_last);
  void extrapolate();
  void brake();
  void publish();
  void violate(const std::string& what);

  std::int64_t now_ns_ = 0;
  driver::Joints q_, dq_;
  Seven dq_d_{}, ddq_d_{};
  Network network_;
  std::vector<std::uint8_t> incoming_;
  bool is_connected_ = false;
  std::uint64_t id_ = 0;
  RobotMode mode_ = RobotMode::kIdle;
  int starts_in_ms_ = -1;  // -1: none starts
  bool is_moving_ = false, is_reported_ = false;
  std::uint32_t motion_number_ = 0;
  int lost_ = 0;
  std::array<bool, kErrors> reason_{};
  std::string violation_;
  int motions_ = 0, ended_ = 0, commands_ = 0, reflexes_ = 0;
};

}  // namespace palpate::franka_bridge
