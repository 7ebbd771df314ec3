#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/export/shape_fields.hpp"
#include "tools/log/record.hpp"
#include "tools/types/type_set.hpp"
#include "tools/view/scene.hpp"

namespace palpate::view {

/// A topic as Foxglove knows it, and its last message as JSON.
struct FoxgloveTopic {
  std::string name, schema_name, schema;
  std::int64_t number = 0;   // of messages so far
  std::int64_t time_us = 0;  // arrival of the last
  std::string json;          // empty if it does not fit its type
};

/// Messages of the bus as Foxglove's topics, with the schemas of palpate-export mcap: each channel
/// of a known type, and for the 3-D view /shape/estimate, /shape/truth, /flange, /tf/object,
/// /tf/flange and /SHAPE_OBSERVATION/points. Only the last message of each is kept, and becomes
/// JSON when it is asked for. For one thread.
class FoxgloveTopics {
 public:
  static constexpr std::size_t kMost = 256;  // later ones are left out

  /// `types`: known in addition to palpate's own; must outlive this. `X_WO`: pose of the object, if
  /// known.
  FoxgloveTopics(const types::TypeSet& types, std::optional<math::Pose> X_WO);

  /// Keeps a message of the bus, unless its type is unknown.
  void take(std::string_view channel, const void* data, int size, std::int64_t time_us);
  /// Makes the messages of the 3-D view from what has changed in the scene since the last call.
  void follow(const Scene& scene);

  std::size_t size() const { return topics_.size(); }
  /// By the order in which they came up.
  const FoxgloveTopic& at(std::size_t index);

 private:
  struct Received {
    std::size_t topic;
    const log::TypeInfo* own;      // or
    const types::Struct* foreign;  // one of the two
    std::vector<std::uint8_t> data;
    bool is_fresh = false;  // not JSON yet
  };
  /// The evaluator of one role's mesh, by its hash.
  struct Mesh {
    std::int64_t hash = 0;
    std::optional<exporting::ShapeEvaluator> evaluator;
  };
  using Key = std::pair<std::string, std::int64_t>;  // channel and fingerprint

  std::optional<std::size_t> add(const std::string& name, const std::string& schema_name,
                                 const std::string& schema);
  void put(const std::string& name, const std::string& schema_name, std::string json,
           std::int64_t time_us);
  bool update(Mesh& mesh, exporting::Law law, const Scene& scene, const shape_t& shape);
  void follow_shape(const Scene& scene);
  void encode(Received& received);

  const types::TypeSet* types_;
  std::optional<math::Pose> X_WO_;
  std::vector<FoxgloveTopic> topics_;
  std::map<Key, Received> received_;
  std::vector<Received*> by_topic_;          // nullptr: made from the scene
  std::map<std::string, std::size_t> made_;  // from the scene, by name
  Mesh estimate_, truth_;
  std::int64_t shape_count_ = 0, truth_count_ = 0, robot_count_ = 0, observation_count_ = 0;
};

}  // namespace palpate::view
