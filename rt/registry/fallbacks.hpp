#pragma once

#include <memory>

#include "core/contact/force_transformer.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Whether the section `node` of a slot contains a fallback section.
bool has_fallback(const config::Node& node);

/// Checks that a fallback can replace the component of `node`; each throws config::Error naming the
/// mismatch. For any slot: a different component, or the same with other parameters.
void check_differs(const config::Node& node);
/// Same sensor.
void check_sensor(const config::Node& node, const Context& context);
/// Same kind and points, so that a target remains valid.
void check_feature(const config::Node& node, const Context& context);

/// True if no component exceeds a plausible magnitude; larger ones overflow in frame
/// transformations.
bool is_plausible(const sensing::Contact& contact) noexcept;

/// Sensor model with a fallback for the same sensor. Both process all signals, so that the fallback
/// is tared and warmed up when required; only one reports contacts. If the first one faults or
/// reports implausible contacts, the fallback is active until reset(). Whether the fallback is good
/// enough for commanding a robot is decided by the creator of the pair.
class SensorFallback final : public sensing::SensorModel {
 public:
  /// `reason`, a string literal: status reason while the fallback is active, which then counts as
  /// degraded; nullptr: the fallback's own status is used.
  SensorFallback(std::unique_ptr<sensing::SensorModel> first,
                 std::unique_ptr<sensing::SensorModel> second, const char* reason)
      : first_(std::move(first)), second_(std::move(second)), reason_(reason) {}

  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override;
  void zero() noexcept override;
  void reset() noexcept override;
  sensing::SensorState save() const noexcept override { return first_->save(); }
  bool restore(const sensing::SensorState& state) noexcept override {
    return first_->restore(state) && second_->restore(state);
  }
  bool in_use() const noexcept { return in_use_; }
  /// Set-up: replaces the first model and returns the previous one.
  void exchange(std::unique_ptr<sensing::SensorModel>& first) noexcept { first_.swap(first); }
  const sensing::Executor* executor(int index) const noexcept override {
    return first_->executor(index);
  }

 private:
  std::unique_ptr<sensing::SensorModel> first_, second_;
  const char* reason_;
  bool in_use_ = false;
  sensing::ContactSet unused_;
};

/// True if every load is finite and of plausible magnitude.
bool are_plausible(const contact::ContactLoads& loads) noexcept;

/// Force transformer with a fallback: if the first one returns implausible loads, the second one
/// processes the same contact and remains active until reset().
class ContactFallback final : public contact::ForceTransformer {
 public:
  ContactFallback(std::unique_ptr<contact::ForceTransformer> first,
                  std::unique_ptr<contact::ForceTransformer> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  int max_nodes() const noexcept override;
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  contact::ContactLoads& out) noexcept override;
  void reset() noexcept { in_use_ = false; }
  bool in_use() const noexcept { return in_use_; }

  /// Set-up: replaces the first transformer and returns the previous one.
  void exchange(std::unique_ptr<contact::ForceTransformer>& first) noexcept { first_.swap(first); }

 private:
  std::unique_ptr<contact::ForceTransformer> first_, second_;
  bool in_use_ = false;
};

}  // namespace palpate::registry
