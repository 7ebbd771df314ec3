#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/point_locator.hpp"
#include "rt/pipeline/slots.hpp"

namespace palpate::pipeline {

/// What somebody wants in a slot.
struct ReplaceRequest {
  std::string slot;      // object, sensing, contact, estimation, deformation, feature, control; all
  std::string instance;  // in sensing and contact, where there are several
  std::string component;   // empty: the present one with other parameters
  std::string parameters;  // YAML mapping; slot all: sections
};

/// `root` as `request` wants it. A new component takes its slot with the parameters given; without
/// one, parameters are put over the present ones. Throws config::Error.
config::Node apply_request(const config::Node& root, const ReplaceRequest& request);

/// What has to be built to come from one configuration to another. Throws config::Error where
/// something else than slots and object differs.
Changes find_changes(const config::Node& present, const config::Node& wanted);

/// The shape that a pipeline had at some moment; sized beforehand, so that taking it is one copy.
struct ShapeSnapshot {
  Eigen::Matrix3Xd positions, velocities;  // 3 x n, in O
  estimation::Estimate estimate;
};

/// New components for one or more slots, to be built beside a pipeline that runs and then to be put
/// in at once (Pipeline::take). Sensor models first run along for a while on what the sensors say.
class Replacement {
 public:
  /// Builds, configures, gives new mechanics the shape of `snapshot` and factors for it. For any
  /// thread but the loop's. Throws config::Error, also for a shape that cannot be carried.
  /// Of the present slots it reads what never changes.
  Replacement(const config::Node& present_root, const config::Node& wanted, const Slots& present,
              const ShapeSnapshot& snapshot);

  const Changes& changes() const noexcept { return changes_; }
  const Slots& slots() const noexcept { return *slots_; }

 private:
  friend class Pipeline;
  void name_successors(const Slots& present);
  void check_keys(const config::Node& present_root, const config::Node& wanted) const;
  void prepare_transfer(const registry::Object& from);
  void warm_up(const ShapeSnapshot& snapshot);
  bool give_shape(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                  const estimation::Estimate& estimate) noexcept;

  Changes changes_;
  std::unique_ptr<Slots> slots_;             // afterwards: the ones that were replaced
  std::vector<int> successors_;              // by new sensor model: the present one's index, or -1
  std::vector<mesh::PointWeights> nodes_;    // of the new mesh in the present one; empty: the same
  Eigen::Matrix3Xd positions_, velocities_;  // room for the transfer
  int ticks_along_ = 0;                      // that new sensor models have run along
};

}  // namespace palpate::pipeline
