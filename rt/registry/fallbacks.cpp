#include "rt/registry/fallbacks.hpp"

#include <algorithm>

#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

/// Description of a sensor model's kind of sensor.
std::string sensor_of(const config::Node& node, const Context& context) {
  const std::string name = node.text("component");
  switch (sensor_kind(name, context)) {
    case plugin::SensorKind::kWrist:
      return "the wrist of arm " + std::to_string(read_arm(node, context));
    case plugin::SensorKind::kFinger:
      return "finger " + std::to_string(node.integer("finger", {0, 4}, 0));
    case plugin::SensorKind::kOther:
      break;
  }
  return plugin::find_plugin(plugins_of(context).sensor_models, name) == nullptr
             ? "no sensor"
             : "the sensor of " + name;
}

/// False also for numbers that are not finite.
bool is_within(const Eigen::Vector3d& vector, double largest) noexcept {
  return (vector.array().abs() <= largest).all();
}

}  // namespace

bool has_fallback(const config::Node& node) { return node.is_mapping("fallback"); }

void check_differs(const config::Node& node) {
  const config::Node fallback = node.child("fallback");
  for (const std::string& key : fallback.keys())
    if (fallback.dump(key) != node.dump(key)) return;
  for (const std::string& key : node.keys())
    if (key != "fallback" && key != "name" && key != "sources" && !fallback.has(key)) return;
  node.fail("fallback", "is the same as the component that it replaces");
}

void check_sensor(const config::Node& node, const Context& context) {
  const config::Node fallback = node.child("fallback");
  const std::string wanted = sensor_of(node, context), given = sensor_of(fallback, context);
  if (node.text("component") == "manual")
    node.fail("fallback", "manual forces cannot have a fallback");
  if (wanted == given) return;
  node.fail("fallback", fallback.text("component") + " is of " + given + ", " +
                            node.text("component") + " of " + wanted + ": it cannot replace it");
}

void check_feature(const config::Node& node, const Context& context) {
  const config::Node fallback = node.child("fallback");
  const auto feature = make_feature(node, context), other = make_feature(fallback, context);
  const auto fail = [&](const std::string& what) {
    node.fail("fallback", what + ": the target would not apply to it");
  };
  if (std::string(feature->kind()) != other->kind())
    fail(std::string("is a ") + other->kind() + ", not a " + feature->kind());
  const auto &points = feature->rest_points(), &others = other->rest_points();
  const bool same = points.size() == others.size() &&
                    std::equal(points.begin(), points.end(), others.begin(),
                               [](const auto& a, const auto& b) { return (a - b).norm() < 1e-6; });
  if (!same) fail("has other rest_points than the feature");
}

bool is_plausible(const sensing::Contact& contact) noexcept {
  constexpr double kLargest = 1e6;  // m, N, N m
  return is_within(contact.location, kLargest) && is_within(contact.wrench.force, kLargest) &&
         is_within(contact.wrench.torque, kLargest);
}

UpdateResult SensorFallback::update(const sensing::Signals& signals,
                                    sensing::ContactSet& contacts) noexcept {
  const int others = contacts.count;
  if (!in_use_) {
    const UpdateResult first = first_->update(signals, contacts);
    in_use_ = first.status == Status::kFault;
    for (int i = others; i < contacts.count; ++i)
      in_use_ = in_use_ || !is_plausible(contacts.contacts[i]);
    if (!in_use_) {
      unused_.count = 0;
      static_cast<void>(second_->update(signals, unused_));
      return first;
    }
  }
  contacts.count = others;
  const UpdateResult second = second_->update(signals, contacts);
  if (second.status != Status::kOk || reason_ == nullptr) return second;
  return {Status::kDegraded, reason_};
}

void SensorFallback::zero() noexcept {
  first_->zero();
  second_->zero();
}

void SensorFallback::reset() noexcept {
  first_->reset();
  second_->reset();
  in_use_ = false;
}

bool are_plausible(const contact::ContactLoads& loads) noexcept {
  constexpr double kLargest = 1e9;  // N; a plausible wrench with a short lever arm stays below it
  return std::all_of(loads.loads.begin(), loads.loads.end(), [](const contact::NodalLoad& load) {
    return is_within(load.force, kLargest);
  });
}

int ContactFallback::max_nodes() const noexcept {
  return std::max(first_->max_nodes(), second_->max_nodes());
}

void ContactFallback::distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                                 contact::ContactLoads& out) noexcept {
  if (!in_use_) {
    first_->distribute(contact, positions, out);
    in_use_ = !are_plausible(out);
  }
  if (in_use_) second_->distribute(contact, positions, out);
}

}  // namespace palpate::registry
