#include "tools/view/foxglove_topics.hpp"

#include <cstring>
#include <stdexcept>

#include "tools/export/foreign_json.hpp"
#include "tools/export/foxglove.hpp"
#include "tools/export/foxglove_schemas.hpp"
#include "tools/export/json_schema.hpp"

namespace palpate::view {
namespace {

constexpr double kLightest = 0.2;  // displacement of the lightest colour, of the longest side

std::int64_t fingerprint(const void* data) {
  std::int64_t value;
  std::memcpy(&value, data, sizeof(value));
  return value;
}

}  // namespace

FoxgloveTopics::FoxgloveTopics(const types::TypeSet& types, std::optional<math::Pose> X_WO)
    : types_(&types), X_WO_(std::move(X_WO)) {}

std::optional<std::size_t> FoxgloveTopics::add(const std::string& name,
                                               const std::string& schema_name,
                                               const std::string& schema) {
  if (topics_.size() >= kMost) return std::nullopt;
  topics_.push_back({name, schema_name, schema, 0, 0, {}});
  by_topic_.push_back(nullptr);
  return topics_.size() - 1;
}

void FoxgloveTopics::take(std::string_view channel, const void* data, int size,
                          std::int64_t time_us) {
  if (size < static_cast<int>(sizeof(std::int64_t))) return;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  const Key key{channel, fingerprint(data)};
  auto found = received_.find(key);
  if (found == received_.end()) {
    const log::TypeInfo* own = log::type_of(bytes, size);
    const types::Struct* foreign = own != nullptr ? nullptr : types_->type_of(data, size);
    if (own == nullptr && foreign == nullptr) return;
    const auto topic =
        own != nullptr ? add(key.first, "palpate." + own->name, exporting::json_schema(*own).dump())
                       : add(key.first, foreign->name, exporting::json_schema(*foreign).dump());
    if (!topic) return;
    found = received_.insert({key, {*topic, own, foreign, {}, false}}).first;
    by_topic_[*topic] = &found->second;
  }
  Received& received = found->second;
  received.data.assign(bytes, bytes + size);
  received.is_fresh = true;
  ++topics_[received.topic].number;
  topics_[received.topic].time_us = time_us;
}

void FoxgloveTopics::encode(Received& received) {
  received.is_fresh = false;
  std::string text;
  const int size = static_cast<int>(received.data.size());
  if (received.own != nullptr) {
    log::Record record(*received.own);
    if (record.decode(received.data.data(), size)) exporting::append_json(record, text);
  } else {
    exporting::append_json(*received.foreign, received.data.data(), size, text);
  }
  topics_[received.topic].json = std::move(text);
}

const FoxgloveTopic& FoxgloveTopics::at(std::size_t index) {
  Received* received = by_topic_[index];
  if (received != nullptr && received->is_fresh) encode(*received);
  return topics_[index];
}

void FoxgloveTopics::put(const std::string& name, const std::string& schema_name, std::string json,
                         std::int64_t time_us) {
  auto found = made_.find(name);
  if (found == made_.end()) {
    const auto topic = add(name, schema_name, exporting::foxglove_schema(schema_name).dump());
    if (!topic) return;
    found = made_.emplace(name, *topic).first;
  }
  FoxgloveTopic& topic = topics_[found->second];
  ++topic.number;
  topic.time_us = time_us;
  topic.json = std::move(json);
}

/// False if no mesh of this shape is known, or one that cannot be drawn.
bool FoxgloveTopics::update(Mesh& mesh, exporting::Law law, const Scene& scene,
                            const shape_t& shape) {
  if (mesh.hash != shape.mesh_hash) {
    const auto whole = scene.meshes().find(shape.mesh_hash);
    if (!whole) return false;
    mesh.hash = shape.mesh_hash;
    mesh.evaluator.reset();
    try {
      mesh.evaluator.emplace(log::mesh_of(*whole), law);
    } catch (const std::runtime_error&) {  // of elements that are not drawn
    }
  }
  return mesh.evaluator && mesh.evaluator->mesh().nodes.cols() == shape.node_count &&
         shape.xyz_count == 3 * shape.node_count;
}

void FoxgloveTopics::follow_shape(const Scene& scene) {
  if (const shape_t* shape = scene.shape.get();
      shape != nullptr && scene.shape.count != shape_count_ &&
      update(estimate_, exporting::Law::kCorotational, scene, *shape)) {
    shape_count_ = scene.shape.count;
    exporting::Instant instant;
    instant.utime = scene.shape.time_us;
    instant.estimate_mesh = &*estimate_.evaluator;
    instant.estimate = log::positions(*shape);
    if (scene.contacts.get() != nullptr) instant.contacts = *scene.contacts.get();
    if (scene.estimate.get() != nullptr) instant.estimated = *scene.estimate.get();
    if (scene.feature.get() != nullptr) instant.feature = *scene.feature.get();
    put("/shape/estimate", "foxglove.SceneUpdate",
        exporting::estimate_scene(instant, kLightest * estimate_.evaluator->mesh().longest_side()),
        instant.utime);
    if (X_WO_)
      put("/tf/object", "foxglove.FrameTransform",
          exporting::object_transform(*X_WO_, instant.utime), instant.utime);
  }
  if (const shape_t* shape = scene.truth.get();
      shape != nullptr && scene.truth.count != truth_count_ &&
      update(truth_, exporting::Law::kNeoHookean, scene, *shape)) {
    truth_count_ = scene.truth.count;
    exporting::Instant instant;
    instant.utime = scene.truth.time_us;
    instant.truth_mesh = &*truth_.evaluator;
    instant.truth = log::positions(*shape);
    put("/shape/truth", "foxglove.SceneUpdate", exporting::truth_scene(instant), instant.utime);
  }
}

void FoxgloveTopics::follow(const Scene& scene) {
  follow_shape(scene);
  const auto& robot = scene.robot[0];
  if (robot.get() != nullptr && robot.count != robot_count_ &&
      math::is_unit_quaternion(robot.get()->quaternion)) {
    robot_count_ = robot.count;
    put("/flange", "foxglove.PoseInFrame", exporting::flange_pose(*robot.get(), robot.time_us),
        robot.time_us);
    put("/tf/flange", "foxglove.FrameTransform",
        exporting::flange_transform(*robot.get(), robot.time_us), robot.time_us);
  }
  const auto& observation = scene.observation;
  if (observation.get() == nullptr || observation.count == observation_count_) return;
  observation_count_ = observation.count;
  const int size = static_cast<int>(observation.data.size());
  const log::TypeInfo* type = log::type_of(observation.data.data(), size);
  if (type == nullptr) return;
  log::Record record(*type);
  if (record.decode(observation.data.data(), size))
    put("/" + std::string(observation.channel) + "/points", "foxglove.PointCloud",
        exporting::point_cloud(record, observation.time_us), observation.time_us);
}

}  // namespace palpate::view
