#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <palpate/contacts_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/obstacles_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/truth_contact_t.hpp>
#include <palpate/world_state_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/shape_chunks.hpp"
#include "tools/export/shape_fields.hpp"
#include "tools/export/source.hpp"

namespace palpate::exporting {

/// One instant of a log: a shape, and other data at that time. All in O, m and N.
struct Instant {
  double time = 0;         // s
  std::int64_t utime = 0;  // us, by the selected clock
  std::int64_t received_utime = 0;

  const ShapeEvaluator* estimate_mesh = nullptr;  // nullptr: the log has no estimate
  Eigen::Matrix3Xd estimate;                      // positions of its nodes
  Eigen::VectorXd node_deviation;                 // m, by node; empty if none is estimated
  int status = 0;                                 // of shape_t

  const ShapeEvaluator* truth_mesh = nullptr;  // nullptr: no truth at this time
  Eigen::Matrix3Xd truth;
  Eigen::Matrix3Xd
      deviation;  // estimate minus truth at the estimate's nodes, m; empty without truth

  std::optional<Stiffness> stiffness;        // of the estimate
  std::optional<Stiffness> truth_stiffness;  // given by the user
  std::optional<contacts_t> contacts;
  std::optional<estimate_t> estimated;
  std::optional<truth_contact_t> truth_contact;
  std::optional<feature_t> feature;
  std::optional<shape_target_t> target;
  std::optional<robot_state_t> robot;
  std::optional<obstacles_t> obstacles;
  std::vector<world_state_t> moved;  // the last one of each obstacle that messages move
};

struct FollowerOptions {
  std::optional<Stiffness> stiffness;        // instead of that of ESTIMATE
  std::optional<Stiffness> truth_stiffness;  // of the simulator's object, which no log contains
};

/// Plays a log's shapes: each SHAPE, with the truth of the same time (linear between two
/// TRUTH_SHAPE) if the log holds it; each TRUTH_SHAPE if there is no SHAPE.
class ShapeFollower {
 public:
  /// Reads the meshes. Throws std::runtime_error if the log has no shape, or no mesh for it.
  ShapeFollower(Source& source, const FollowerOptions& options);

  bool has_estimate() const { return has_estimate_; }
  bool has_truth() const { return has_truth_; }
  /// Whether shapes come with standard deviations.
  bool has_deviation() const { return has_deviation_; }

  /// Whether a log holds any shape at all.
  static bool is_possible(const Source& source);
  /// Channels that it reads.
  static const std::vector<std::string>& channels();

  using Take = std::function<void(const Instant&)>;
  /// For callers that read the log themselves: begin(), follow() for each message of channels(),
  /// end().
  void begin();
  void follow(const Message& message, const Take& take);
  void end(const Take& take);

  /// Calls `take` for each shape within the times of the source's options, in their order.
  void each(const std::string& title, const Take& take);

  /// At `rate` Hz from the first shape on (every shape if 0): the last shape at or before each of
  /// these times, with `time` that of the frame. Shapes are not repeated beyond one second of
  /// silence.
  void sample(const std::string& title, double rate, const Take& take);

 private:
  struct Truth {
    std::int64_t utime = 0;
    std::int64_t received_utime = 0;
    std::int64_t mesh = 0;
    Eigen::Matrix3Xd positions;
  };

  void read_meshes(Source& source);
  void add_shape(const shape_t& shape, const Message& message);
  void add_truth(const shape_t& shape, const Message& message, const Take& take);
  void settle(std::int64_t now, const Take& take);
  void give(Instant& instant, const Take& take);
  void put_truth(Instant& instant, const Truth& before, const Truth& after);

  Source* source_;
  FollowerOptions options_;
  bool has_estimate_ = false, has_truth_ = false, has_deviation_ = false;
  std::map<std::int64_t, std::unique_ptr<ShapeEvaluator>> estimates_, truths_;  // by hash
  std::map<std::pair<std::int64_t, std::int64_t>, std::unique_ptr<log::PlantPoints>> places_;
  bus::ShapeAssembler shape_chunks_, truth_chunks_;
  Instant latest_;               // other known data
  std::deque<Instant> waiting_;  // pending, for the truth of their time
  std::optional<Truth> last_truth_;
};

/// Quantity shown by the colour of a shape.
enum class Quantity { kNone, kDisplacement, kDeviation, kUncertainty, kStrain, kStress };

/// Presentation of a quantity: caption of its colour bar, and the factor for its unit.
struct QuantityText {
  std::string name, unit;
  double factor = 1;
};
QuantityText text_of(Quantity quantity);

/// The quantity at the nodes of the solid shape: the estimate, or the truth if there is no
/// estimate; SI. Empty if the instant does not provide it.
Eigen::VectorXd values_at_nodes(const Instant& instant, Quantity quantity);

/// Whether an instant provides the quantity.
bool has_quantity(const Instant& instant, Quantity quantity);

}  // namespace palpate::exporting
