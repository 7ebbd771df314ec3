#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <palpate/biotac_t.hpp>
#include <palpate/channels.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/config_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/discrepancy_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/obstacles_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/truth_contact_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <palpate/world_state_t.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/shape_chunks.hpp"
#include "tools/types/message_values.hpp"

namespace palpate::view {

/// The last message of a channel: stored as received, decoded on demand.
template <class Message>
struct Latest {
  using Type = Message;
  Latest(const char* name) : channel(name) {}  // NOLINT(google-explicit-constructor): in lists

  const char* channel;
  std::vector<std::uint8_t> data;
  std::int64_t time_us = 0;  // time of arrival: wall clock, or the log's
  std::int64_t count = 0;    // decoded so far
  bool fresh = false;        // not decoded yet
  bool there = false;
  Message message{};

  /// nullptr if there is none.
  const Message* get() const { return there ? &message : nullptr; }
};

/// The last whole shape of a channel; decoded and joined from its chunks when they arrive.
struct LatestShape {
  const char* channel;
  std::int64_t time_us = 0;  // time of arrival: wall clock, or the log's
  std::int64_t count = 0;    // whole ones so far
  bool there = false;
  shape_t message{};
  bus::ShapeAssembler assembler{};

  /// nullptr if there is none.
  const shape_t* get() const { return there ? &message : nullptr; }
  /// False if the chunk is rejected.
  bool take(shape_t&& chunk, std::int64_t arrival_us);
};

/// A fingertip's last message, and the dynamic pressure of the messages up to it.
struct Fingertip {
  static constexpr std::size_t kMostPac = 400;

  const char* channel;
  std::int64_t time_us = 0;  // time of arrival: wall clock, or the log's
  bool there = false;
  biotac_t message{};
  /// Counts, oldest first, at most kMostPac of them; without a gap in between: a lost message
  /// removes those before it.
  std::vector<std::int32_t> pac{};

  /// nullptr if there is none.
  const biotac_t* get() const { return there ? &message : nullptr; }
  void take(const biotac_t& next, std::int64_t next_us);
};

/// The last WORLD_STATE of one obstacle.
struct MovedObstacle {
  std::int64_t time_us = 0;  // time of arrival: wall clock, or the log's
  world_state_t message{};
};

/// An event with a sequence number, so that a reader knows which ones it has received.
struct NumberedEvent {
  std::int64_t number = 0;
  std::int64_t time_us = 0;
  component_event_t event;
};

inline constexpr std::int64_t kOld = 1000;  // ms, age from which a message is no longer shown

/// Number of HEALTH's phases: the whole cycle first, the wake-up last.
inline constexpr int kPhases = 10;

/// Norm of a feature's error, m, rad or 1/m; NaN without a target.
double error_norm(const feature_t& feature);

/// State of the cell at one time: the last message of each channel, meshes, and the last events. No
/// message is trusted: one of wrong type, size or content is counted and dropped. For one thread.
class Scene {
 public:
  static constexpr std::size_t kMostEvents = 500;
  /// Of obstacles that messages move, whatever their names; as many as a configuration may have.
  static constexpr std::size_t kMostMoved = contacts_t::MOST_OBSTACLES;

  static constexpr std::string_view kEvents = channel::kComponentEvent;
  static bool is_mesh(std::string_view channel);

  /// All channels that accept() takes.
  static const std::vector<std::string_view>& channels();

  /// Takes messages of these types too, on any other channel.
  void describe(types::TypeSet types) { described_ = types::MessageValues(std::move(types)); }

  /// Passes one message; cheap, as there may be thousands per second. False if its channel is none
  /// of channels() and its type not described.
  bool accept(std::string_view channel, const void* data, int size, std::int64_t time_us);

  /// Decodes the messages that have arrived since the last call.
  void refresh();

  /// Resets to the initial state, except for known meshes: after a jump in a log.
  void forget_messages();

  LatestShape shape{channel::kShape}, truth{channel::kTruthShape};
  Latest<truth_contact_t> truth_contact{channel::kTruthContact};
  Latest<contacts_t> contacts{channel::kContacts};
  Latest<obstacles_t> obstacles{channel::kObstacles};
  Latest<estimate_t> estimate{channel::kEstimate};
  Latest<discrepancy_t> discrepancy{channel::kDiscrepancy};
  Latest<feature_t> feature{channel::kFeature};
  Latest<health_t> health{channel::kHealth};
  Latest<config_t> config{channel::kConfig};
  Latest<twist_command_t> twist{channel::kTwistCommand};
  Latest<manual_force_t> manual{channel::kManualForce};
  Latest<shape_observation_t> observation{channel::kShapeObservation};
  std::array<Latest<robot_state_t>, 2> robot{{{channel::kRobotState}, {channel::kRobotState1}}};
  std::array<Latest<hand_state_t>, 2> hand{{{channel::kHandState}, {channel::kHandState1}}};
  /// Of the first arm's hand, then of the second's; decoded when they arrive.
  std::array<Fingertip, 10> fingertips{{{channel::kBiotac0},
                                        {channel::kBiotac1},
                                        {channel::kBiotac2},
                                        {channel::kBiotac3},
                                        {channel::kBiotac4},
                                        {"BIOTAC_0_1"},
                                        {"BIOTAC_1_1"},
                                        {"BIOTAC_2_1"},
                                        {"BIOTAC_3_1"},
                                        {"BIOTAC_4_1"}}};

  /// Of the obstacle with this name; nullptr if there is none.
  const MovedObstacle* moved(const std::string& name) const;
  const bus::MeshAssembler& meshes() const { return meshes_; }
  /// The last messages of described types.
  const types::MessageValues& described() const { return described_; }
  const std::deque<NumberedEvent>& events() const { return events_; }
  /// Incremented by forget_messages().
  std::int64_t generation() const { return generation_; }
  /// Messages of another type or size, and those with impossible contents.
  std::int64_t rejected() const { return rejected_ + meshes_.rejected(); }

 private:
  template <class Visit>
  void for_each_latest(Visit visit);
  void take(const world_state_t& message, std::int64_t time_us);

  bus::MeshAssembler meshes_;
  types::MessageValues described_{{}};
  std::map<std::string, MovedObstacle> moved_;  // by name
  std::deque<NumberedEvent> events_;
  std::int64_t event_count_ = 0;
  std::int64_t generation_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace palpate::view
