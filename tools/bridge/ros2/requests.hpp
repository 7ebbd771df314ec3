#pragma once

#include <list>
#include <memory>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "intake.hpp"
#include "participant.hpp"
#include "rt/client/client.hpp"

// What nodes of ROS 2 ask of palpated.

namespace palpate::ros2_bridge {

/// A service std_srvs/Trigger for one event of palpated, as rmw_cyclonedds_cpp has services: two
/// topics, whose messages begin with the client's number. Answers when palpated has.
class TriggerService {
 public:
  /// `name`: of the service, whose last part is the event. The client outlives this object.
  TriggerService(const Participant& participant, const std::string& name, const std::string& event,
                 client::Client& palpated);

  /// Takes requests and sends the replies that are due. `now_us`: system time.
  void cycle(std::int64_t now_us);

 private:
  struct Reply {
    std::uint64_t client = 0;
    std::int64_t sequence_number = 0;
    dds_guid_t participant{};  // of the client
    bool is_known = false;     // palpated has answered
    std::int64_t until_us = 0;
    bool success = false;
    std::string message;
  };
  void ask(const TriggerRequest& request, std::int64_t now_us);
  bool is_heard_by(const dds_guid_t& participant) const;
  void send(const Reply& reply);

  std::string event_;
  client::Client& palpated_;
  Reader<TriggerRequest> requests_;
  Writer<TriggerResponse> replies_;
  std::list<std::shared_ptr<Reply>> pending_;
};

/// The same events as texts of std_msgs/String, for nodes with another middleware. palpated's
/// answers are among its diagnostics.
class CommandTopic {
 public:
  CommandTopic(const Participant& participant, const std::string& topic, client::Client& palpated);

  void cycle(std::int64_t now_us);
  Intake& intake() { return intake_; }

 private:
  client::Client& palpated_;
  Reader<String> commands_;
  Intake intake_;
};

/// Targets of the shape's feature by messages of one type.
class TargetTopic {
 public:
  struct Options {
    std::string topic;
    std::string kind = "point";       // of the feature: point (PointStamped) or pose (PoseStamped)
    std::vector<double> rest_points;  // x, y, z in O, m; empty: as palpated configures
    std::string base = "base_link", object = "object";  // names of W and O
    math::Pose X_WO = math::Pose::Identity();
    Clock clock;
  };

  TargetTopic(const Participant& participant, const Options& options, client::Client& palpated);

  void cycle(std::int64_t now_us);
  Intake& intake() { return intake_; }

 private:
  void take(const Header& header, std::optional<math::Pose> pose, std::int64_t now_us);

  Options options_;
  client::Client& palpated_;
  std::unique_ptr<Reader<PointStamped>> points_;
  std::unique_ptr<Reader<PoseStamped>> poses_;
  Intake intake_;
};

}  // namespace palpate::ros2_bridge
