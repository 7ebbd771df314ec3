#include "requests.hpp"

#include <array>
#include <cstdio>
#include <cstring>

#include "conversions.hpp"

namespace palpate::ros2_bridge {
namespace {

constexpr int kRequestDepth = 10;               // as of ROS 2's services
constexpr std::int64_t kDiscovery = 1'000'000;  // us, that a reply waits for its reader
constexpr std::size_t kMostPending = 32;        // commands that palpated has not answered
constexpr std::array<std::string_view, 4> kEvents = {"start", "stop", "reset", "zero"};

Participant::Endpoint endpoint_of(const Participant& participant, const std::string& name,
                                  bool is_request) {
  Participant::Endpoint endpoint{name, Quality::kReliable, kRequestDepth};
  endpoint.prefix = is_request ? "rq/" : "rr/";
  endpoint.suffix = is_request ? "Request" : "Reply";
  // By which a client finds out that both topics are of one server.
  endpoint.user_data = "serviceid=" + participant.id() + "/" + name + ";";
  return endpoint;
}

client::Client::OnAnswer printed(const std::string& what) {
  return [what](const client::Answer& answer) {
    if (answer.last && !answer.done())
      std::fprintf(stderr, "%s: %s %s\n", what.c_str(), answer.event.c_str(),
                   answer.reason.c_str());
  };
}

}  // namespace

TriggerService::TriggerService(const Participant& participant, const std::string& name,
                               const std::string& event, client::Client& palpated)
    : event_(event),
      palpated_(palpated),
      requests_(participant, endpoint_of(participant, name, true)),
      replies_(participant, endpoint_of(participant, name, false)) {}

void TriggerService::ask(const TriggerRequest& request, std::int64_t now_us) {
  const auto reply = std::make_shared<Reply>();
  reply->client = request.client;
  reply->sequence_number = request.sequence_number;
  if (dds_builtintopic_endpoint_t* const writer =
          dds_get_matched_publication_data(requests_.entity(), requests_.publication())) {
    reply->participant = writer->participant_key;
    dds_builtintopic_free_endpoint(writer);
  }
  pending_.push_back(reply);
  if (palpated_.pending() >= kMostPending) {
    reply->is_known = true;
    reply->message = "refused: too many requests at a time";
    return;
  }
  palpated_.ask(client::make_command({event_}), now_us, [reply](const client::Answer& answer) {
    reply->is_known = answer.last;
    reply->success = answer.done();
    reply->message = answer.event;
    if (!answer.reason.empty())
      reply->message += (answer.event.empty() ? "" : ": ") + answer.reason;
  });
}

/// Whether the client's reader of replies has been discovered: before, they would be lost.
bool TriggerService::is_heard_by(const dds_guid_t& participant) const {
  std::array<dds_instance_handle_t, 64> readers{};
  const dds_return_t count =
      dds_get_matched_subscriptions(replies_.entity(), readers.data(), readers.size());
  for (dds_return_t i = 0; i < count && i < static_cast<dds_return_t>(readers.size()); ++i) {
    dds_builtintopic_endpoint_t* const reader =
        dds_get_matched_subscription_data(replies_.entity(), readers[static_cast<std::size_t>(i)]);
    if (reader == nullptr) continue;
    const bool is_same =
        std::memcmp(&reader->participant_key, &participant, sizeof(participant)) == 0;
    dds_builtintopic_free_endpoint(reader);
    if (is_same) return true;
  }
  return false;
}

void TriggerService::send(const Reply& reply) {
  std::string message = reply.message;
  TriggerResponse response{};
  response.client = reply.client;
  response.sequence_number = reply.sequence_number;
  response.success = reply.success;
  response.message = message.data();
  replies_.write(response);
}

void TriggerService::cycle(std::int64_t now_us) {
  while (const TriggerRequest* const request = requests_.next()) ask(*request, now_us);
  for (auto reply = pending_.begin(); reply != pending_.end();) {
    Reply& due = **reply;
    if (due.is_known && due.until_us == 0) due.until_us = now_us + kDiscovery;
    if (due.is_known && (now_us >= due.until_us || is_heard_by(due.participant))) {
      send(due);
      reply = pending_.erase(reply);
    } else {
      ++reply;
    }
  }
}

CommandTopic::CommandTopic(const Participant& participant, const std::string& topic,
                           client::Client& palpated)
    : palpated_(palpated),
      commands_(participant, {topic, Quality::kReliable, kRequestDepth}),
      intake_(topic, Clock{false}) {}

void CommandTopic::cycle(std::int64_t now_us) {
  while (const String* const command = commands_.next()) {
    const std::string event = command->data;
    if (std::find(kEvents.begin(), kEvents.end(), event) == kEvents.end()) {
      intake_.refuse("is none of start, stop, reset, zero");
      continue;
    }
    if (palpated_.pending() >= kMostPending) {
      intake_.refuse("too many commands at a time");
      continue;
    }
    intake_.admit({}, now_us);
    palpated_.ask(client::make_command({event}), now_us, printed(event));
  }
}

TargetTopic::TargetTopic(const Participant& participant, const Options& options,
                         client::Client& palpated)
    : options_(options), palpated_(palpated), intake_(options.topic, options.clock) {
  const Participant::Endpoint endpoint{options.topic, Quality::kReliable, 1};
  if (options.kind == "pose")
    poses_ = std::make_unique<Reader<PoseStamped>>(participant, endpoint);
  else
    points_ = std::make_unique<Reader<PointStamped>>(participant, endpoint);
}

void TargetTopic::take(const Header& header, std::optional<math::Pose> pose, std::int64_t now_us) {
  if (!pose) return intake_.refuse("is not finite, or its quaternion is not of unit length");
  if (options_.base == header.frame_id)
    pose = options_.X_WO.inverse() * *pose;
  else if (options_.object != header.frame_id)
    return intake_.refuse("is in another frame than base and object");
  if (!intake_.admit(header.stamp, now_us)) return;
  const Pose target = pose_message(*pose);
  const auto& [p, q] = target;
  std::vector<double> values = {p.x, p.y, p.z};
  if (poses_) values.insert(values.end(), {q.w, q.x, q.y, q.z});
  palpated_.ask(client::make_target(options_.kind, options_.rest_points, values), now_us,
                printed("target"));
}

void TargetTopic::cycle(std::int64_t now_us) {
  if (poses_) {
    while (const PoseStamped* const message = poses_->next())
      take(message->header, pose_of(message->pose), now_us);
    return;
  }
  while (const PointStamped* const message = points_->next())
    take(message->header, pose_of({message->point, {0, 0, 0, 1}}), now_us);
}

}  // namespace palpate::ros2_bridge
