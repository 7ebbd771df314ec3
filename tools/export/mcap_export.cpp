#include "tools/export/mcap_export.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/event_log_reader.hpp"
#include "tools/export/foreign_json.hpp"
#include "tools/export/foxglove.hpp"
#include "tools/export/foxglove_schemas.hpp"
#include "tools/export/json_schema.hpp"
#include "tools/export/mcap_writer.hpp"
#include "tools/export/protobuf_encoder.hpp"

namespace palpate::exporting {
namespace {

/// Displacement with the lightest colour, relative to the object's largest side.
constexpr double kLightest = 0.2;

/// MCAP counts unsigned ns; a sender's clock may have any value.
std::uint64_t nanoseconds(std::int64_t utime) {
  return 1000 *
         static_cast<std::uint64_t>(std::clamp<std::int64_t>(utime, 0, bus::kLatestEventTime));
}

class Exporter {
 public:
  Exporter(Source& source, const McapOptions& options, const std::filesystem::path& file)
      : source_(&source), options_(options), mcap_(file, options.compression) {
    if (options.protobuf) protobuf_.emplace();
    for (const ChannelSurvey& channel : source.found().channels)
      if (source.is_selected(channel) || source.is_foreign_selected(channel)) add_channel(channel);
    const bool wants_scene = options.scene_rate > 0 && ShapeFollower::is_possible(source) &&
                             (selects(channel::kShape) || selects(channel::kTruthShape));
    if (!wants_scene) return;
    try {
      follower_.emplace(source, FollowerOptions{});
    } catch (const std::runtime_error& error) {
      std::cerr << "warning: no scenes for 3-D views: " << error.what() << std::endl;
    }
  }

  std::vector<Written> write() {
    mcap_.add_metadata("palpate", {{"version", PALPATE_VERSION},
                                   {"units", "SI, angles in rad, utime in us"},
                                   {"log_time", source_->options().clock == Clock::kReceived
                                                    ? "when the log received the message"
                                                    : "utime of the sender"}});
    const auto& followed = ShapeFollower::channels();
    const auto follows = [&](const std::string& channel) {
      return follower_ && std::find(followed.begin(), followed.end(), channel) != followed.end();
    };
    const auto take = [this](const Instant& instant) { add_scene(instant); };
    if (follower_) follower_->begin();
    source_->read(
        "writing MCAP",
        [&](const ChannelSurvey& channel) {
          return source_->is_selected(channel) || follows(channel.channel);
        },
        [&](const Message& message) {
          if (source_->is_in_time(message.time)) add_message(message);
          if (follows(message.event.channel)) follower_->follow(message, take);
        },
        [&](const ForeignMessage& message) { add_message(message); });
    if (follower_) follower_->end(take);
    mcap_.finish();
    return {{mcap_.path(), "messages", static_cast<std::int64_t>(mcap_.message_count())}};
  }

 private:
  using Key = std::pair<std::string, const void*>;  // channel, and its type

  bool selects(const std::string& name) const {
    return std::any_of(channels_.begin(), channels_.end(),
                       [&name](const auto& entry) { return entry.first.first == name; });
  }

  void add_channel(const ChannelSurvey& channel) {
    if (channel.messages == channel.broken) return;
    const bool is_own = channel.type != nullptr;
    const std::string name = (is_own ? "palpate." : "") + channel.type_name();
    auto& schema = schemas_[name];
    if (schema == 0)
      schema = mcap_.add_schema(
          name, (is_own ? json_schema(*channel.type) : json_schema(*channel.foreign)).dump());
    channels_[{channel.channel, channel.type_address()}] =
        mcap_.add_channel(channel.channel, schema, {{"lcm_type", channel.type_name()}});
  }

  /// Other types have no sequence number and no time of their own.
  void add_message(const ForeignMessage& message) {
    const auto found = channels_.find({message.event.channel, &message.type});
    if (found == channels_.end()) return;
    text_.clear();
    append_json(message.type, message.event.data, message.event.size, text_);
    mcap_.add_message(found->second, foreign_sequences_[found->second]++,
                      nanoseconds(message.utime), nanoseconds(message.utime), text_);
  }

  void add_message(const Message& message) {
    const auto found = channels_.find({message.event.channel, &message.record.type()});
    if (found == channels_.end()) return;
    text_.clear();
    append_json(message.record, text_);
    mcap_.add_message(found->second, static_cast<std::uint32_t>(message.record.seq()),
                      nanoseconds(message.utime), nanoseconds(message.record.utime()), text_);
    if (!(options_.scene_rate > 0)) return;
    const std::string& type = message.record.type().name;
    if (type == "robot_state_t")
      add_flange(message);
    else if (type == "shape_observation_t")
      put("/" + message.event.channel + "/points", "foxglove.PointCloud",
          point_cloud(message.record, message.utime), message.utime);
  }

  void add_flange(const Message& message) {
    if (message.event.channel != channel::kRobotState || !is_due(next_flange_, message.time))
      return;
    robot_state_t state;
    if (!bus::checked_decode(state, message.event.data, message.event.size) ||
        !math::is_unit_quaternion(state.quaternion))
      return;
    put("/flange", "foxglove.PoseInFrame", flange_pose(state, message.utime), message.utime);
    put("/tf", "foxglove.FrameTransform", flange_transform(state, message.utime), message.utime);
  }

  void add_scene(const Instant& instant) {
    if (!is_due(next_scene_, instant.time)) return;
    if (options_.X_WO)
      put("/tf", "foxglove.FrameTransform", object_transform(*options_.X_WO, instant.utime),
          instant.utime);
    if (instant.estimate_mesh != nullptr && selects(channel::kShape))
      put("/shape/estimate", "foxglove.SceneUpdate",
          estimate_scene(instant, kLightest * instant.estimate_mesh->mesh().longest_side()),
          instant.utime);
    if (instant.truth_mesh != nullptr && selects(channel::kTruthShape))
      put("/shape/truth", "foxglove.SceneUpdate", truth_scene(instant), instant.utime);
  }

  /// At most scene_rate times a second.
  bool is_due(double& next, double time) const {
    const double period = 1 / options_.scene_rate;
    if (time < next - 0.01 * period) return false;  // times are rounded to us
    next = (next < time - period ? time : next) + period;
    return true;
  }

  void put(const std::string& topic, const std::string& schema_name, const std::string& json,
           std::int64_t utime) {
    auto& schema = schemas_[schema_name];
    if (schema == 0)
      schema = protobuf_ ? mcap_.add_schema(schema_name, protobuf_->descriptions(),
                                            MessageEncoding::kProtobuf)
                         : mcap_.add_schema(schema_name, foxglove_schema(schema_name).dump());
    const auto [found, is_new] = topics_.try_emplace(topic);
    if (is_new) found->second.channel = mcap_.add_channel(topic, schema);
    mcap_.add_message(found->second.channel, found->second.sequence++, nanoseconds(utime),
                      nanoseconds(utime), protobuf_ ? protobuf_->encode(schema_name, json) : json);
  }

  struct Topic {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
  };

  Source* source_;
  McapOptions options_;
  McapWriter mcap_;
  std::optional<ShapeFollower> follower_;
  std::optional<ProtobufEncoder> protobuf_;
  std::map<std::string, std::uint16_t> schemas_;  // by name
  std::map<Key, std::uint16_t> channels_;
  std::map<std::uint16_t, std::uint32_t> foreign_sequences_;
  std::map<std::string, Topic> topics_;  // of the added channels
  double next_flange_ = -1e300, next_scene_ = -1e300;
  std::string text_;
};

}  // namespace

std::vector<Written> export_mcap(Source& source, const McapOptions& options,
                                 const std::filesystem::path& file) {
  if (file.extension() != ".mcap")
    throw std::runtime_error(file.string() + ": the name must end in .mcap");
  Exporter exporter(source, options, file);
  return exporter.write();
}

}  // namespace palpate::exporting
