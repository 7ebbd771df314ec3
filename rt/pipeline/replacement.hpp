#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/point_locator.hpp"
#include "rt/pipeline/component_set.hpp"

namespace palpate::pipeline {

/// Request to replace the component of a slot.
struct ReplaceRequest {
  std::string slot;      // object, sensing, contact, estimation, deformation, feature, control; all
  std::string instance;  // for sensing and contact, which have several instances
  std::string component;   // empty: the present component with other parameters
  std::string parameters;  // YAML mapping; for slot all: sections
};

/// `root` modified by `request`. A new component uses the given parameters; without a component,
/// they are merged over the present ones. Throws config::Error.
config::Node apply_request(const config::Node& root, const ReplaceRequest& request);

/// Components that must be built to change from one configuration to another. Throws config::Error
/// if anything other than slots and object differs.
Changes find_changes(const config::Node& present, const config::Node& wanted);

/// Shape of a pipeline at one time; allocated in advance, so that filling it is a copy.
struct ShapeSnapshot {
  Eigen::Matrix3Xd positions, velocities;  // 3 x n, in O
  estimation::Estimate estimate;
};

/// New components for one or more slots, built while a pipeline runs and then exchanged together
/// (Pipeline::take). Sensor models first run in parallel for a while on the signals.
class Replacement {
 public:
  /// Builds and configures the components, initialises new mechanics with the shape of `snapshot`
  /// and factors for it. For any thread but the loop's. Throws config::Error, also for a shape that
  /// cannot be transferred. Accesses only constant parts of the present components.
  Replacement(const config::Node& present_root, const config::Node& wanted,
              const ComponentSet& present, const ShapeSnapshot& snapshot);

  const Changes& changes() const noexcept { return changes_; }
  const ComponentSet& components() const noexcept { return *components_; }

 private:
  friend class Pipeline;
  void name_successors(const ComponentSet& present);
  void check_keys(const config::Node& present_root, const config::Node& wanted) const;
  void prepare_transfer(const registry::Object& from);
  void warm_up(const ShapeSnapshot& snapshot);
  bool give_shape(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                  const estimation::Estimate& estimate) noexcept;

  Changes changes_;
  std::unique_ptr<ComponentSet> components_;  // after the exchange: the replaced ones
  /// by new sensor model: index of the one that it replaces, or -1
  std::vector<int> successors_;
  /// Nodes of the new mesh in the present one; empty: the same mesh.
  std::vector<mesh::PointWeights> nodes_;
  Eigen::Matrix3Xd positions_, velocities_;  // workspace of the transfer
  int warmup_ticks_ = 0;                     // for which new sensor models have run in parallel
};

/// Standby components that replace those in the slots after a fault; while they are active the
/// original ones are stored here.
struct Fallback {
  std::unique_ptr<Replacement> replacement;  // nullptr: not configured
  bool in_use = false;
};

/// Components named by the key `fallback` of estimation and deformation, which change together, of
/// feature and of control: a section like that of the slot itself. Built, given the shape and
/// warmed up in advance. (Those of sensing and contact, which have lists, are in ComponentSet.)
struct Fallbacks {
  /// For any thread but the loop's. Throws config::Error, also for unknown keys.
  Fallbacks(const config::Node& root, const ComponentSet& present, const ShapeSnapshot& snapshot);

  bool in_use() const noexcept { return mechanics.in_use || feature.in_use || steering.in_use; }

  Fallback mechanics;
  /// With its own controller; this and the controller's fallback are never active together.
  Fallback feature;
  Fallback steering;
};

}  // namespace palpate::pipeline
