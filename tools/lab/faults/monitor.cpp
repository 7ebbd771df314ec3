#include "tools/lab/faults/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>
#include <palpate/compensated_wrench_t.hpp>
#include <palpate/config_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/discrepancy_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <palpate/unknown_contact_t.hpp>
#include <utility>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/text.hpp"
#include "tools/lab/faults/stream.hpp"

namespace palpate::faults {
namespace {

constexpr double kRounding = 1 + 1e-9;

bool finite(double number) { return std::isfinite(number); }
template <class T>
bool finite(const std::vector<T>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](T x) { return std::isfinite(x); });
}
template <class T, std::size_t kCount>
bool finite(const T (&numbers)[kCount]) {
  return std::all_of(std::begin(numbers), std::end(numbers),
                     [](const auto& x) { return finite(x); });
}
template <class... Fields>
bool all_finite(const Fields&... fields) {
  return (finite(fields) && ...);
}

bool all_finite_in(const twist_command_t& m) { return all_finite(m.twist); }
bool all_finite_in(const contacts_t& m) {
  return all_finite(m.location, m.wrench, m.deviation, m.obstacle_force, m.predicted_place,
                    m.predicted_normal, m.predicted_force, m.predicted_friction);
}
bool all_finite_in(const compensated_wrench_t& m) {
  return all_finite(m.age, m.wrench_s, m.deviation_s, m.wrench_g, m.deviation_g);
}
bool all_finite_in(const estimate_t& m) {
  return all_finite(m.grasp_position, m.grasp_quaternion, m.grasp_deviation, m.reaction,
                    m.reaction_deviation, m.bias, m.bias_deviation, m.log_young_modulus,
                    m.log_young_modulus_deviation, m.poisson_ratio, m.poisson_ratio_deviation,
                    m.innovation_test, m.unknown_contact_location, m.unknown_contact_force,
                    m.unknown_contact_deviation);
}
bool all_finite_in(const discrepancy_t& m) {
  return all_finite(m.duration, m.test, m.threshold, m.difference, m.deviation, m.probability,
                    m.location, m.value);
}
bool all_finite_in(const unknown_contact_t& m) {
  return all_finite(m.location, m.location_deviation, m.force, m.force_deviation);
}
bool all_finite_in(const feature_t& m) {
  return all_finite(m.value, m.target, m.error, m.unreachable);
}
bool all_finite_in(const shape_t& m) { return all_finite(m.xyz, m.deviation); }
bool all_finite_in(const shape_mesh_t& m) { return all_finite(m.rest_xyz); }
bool all_finite_in(const health_t& m) {
  return all_finite(m.p50_us, m.p99_us, m.p999_us, m.max_us, m.age_ms);
}
bool all_finite_in(const config_t&) { return true; }
bool all_finite_in(const component_event_t&) { return true; }

/// FNV-1a.
void add(std::uint64_t& hash, const bus::Published& message) {
  if (hash == 0) hash = 14695981039346656037ULL;
  for (std::size_t i = kHeaderSize; i < message.data.size(); ++i)
    hash = (hash ^ message.data[i]) * 1099511628211ULL;
}

}  // namespace

void Monitor::complain(int& counter, const std::string& what) {
  if (++counter == 1 && complaint_.empty()) complaint_ = what;
}

template <class Message>
bool Monitor::read(const bus::Published& message, Message& into) {
  const int size = static_cast<int>(message.data.size());
  if (!bus::checked_decode(into, message.data.data(), size)) {
    complain(undecoded_, message.channel + ": cannot be decoded");
    return false;
  }
  if (!all_finite_in(into)) complain(not_finite_, message.channel + ": a number is not finite");
  return true;
}

void Monitor::look(const bus::Published& message, const std::optional<Eigen::Vector3d>& p_W_E,
                   std::optional<bool> restrained) {
  ++messages_;
  const std::string& channel = message.channel;
  const auto check = [&](auto into) { return read(message, into); };
  if (channel == channel::kTwistCommand) {
    look_at_command(message, p_W_E, restrained);
    add(hash_, message);
  } else if (channel == channel::kContacts) {
    check(contacts_t());
    add(contact_hash_, message);
  } else if (channel == channel::kWrenchCompensated) {
    check(compensated_wrench_t());
    add(contact_hash_, message);  // also has the sender's clock
  } else if (channel == channel::kEstimate) {
    check(estimate_t());
    add(hash_, message);
  } else if (channel == channel::kUnknownContact) {
    check(unknown_contact_t());
    add(hash_, message);
  } else if (channel == channel::kDiscrepancy) {
    check(discrepancy_t());
    add(hash_, message);
  } else if (channel == channel::kFeature) {
    check(feature_t());
    add(hash_, message);
  } else if (channel == channel::kShape) {
    check(shape_t());
    add(hash_, message);
  } else if (channel == channel::kShapeMesh) {
    check(shape_mesh_t());
  } else if (channel == channel::kConfig) {
    check(config_t());
  } else if (channel == channel::kHealth) {
    look_at_health(message);
  } else if (channel == channel::kComponentEvent) {
    component_event_t event;
    if (read(message, event))
      events_.push_back({message.time_ns, bus::get_text(event.slot), bus::get_text(event.event),
                         bus::get_text(event.reason)});
  } else {
    complain(undecoded_, channel + ": the daemon has no such channel");
  }
}

/// Speed is always checked. While the gate follows a request: the acceleration limit, and that the
/// flange does not leave the workspace. While it brakes: from full speed to zero in 100 ms, and
/// never accelerating.
void Monitor::look_at_command(const bus::Published& message,
                              const std::optional<Eigen::Vector3d>& p_W_E,
                              std::optional<bool> known_restrained) {
  twist_command_t command;
  if (!read(message, command)) return;
  const Eigen::Map<const Eigen::Vector3d> linear(command.twist), angular(command.twist + 3);
  const bool shrinks =
      linear.norm() <= last_linear_.norm() && angular.norm() <= last_angular_.norm();
  const bool restrained = known_restrained.value_or(shrinks);
  // Messages in between were lost.
  const double cycles = std::max(1, command.seq - std::exchange(last_seq_, command.seq));
  if (linear.norm() > kRounding * limits_.linear_speed ||
      angular.norm() > kRounding * limits_.angular_speed)
    complain(beyond_limits_, "command above the limit of speed");
  const Eigen::Vector3d step = linear - last_linear_, turn = angular - last_angular_;
  constexpr double kStopTime = 0.1;  // s, of the gate
  // Braking ramps each axis separately.
  const auto allowed = [&](double acceleration, double speed) {
    return kRounding * period_ * cycles *
           (restrained ? std::max(acceleration, std::sqrt(3.0) * speed / kStopTime) : acceleration);
  };
  const bool too_fast =
      step.norm() > allowed(limits_.linear_acceleration, limits_.linear_speed) + 1e-12;
  const bool turns_too_fast =
      turn.norm() > allowed(limits_.angular_acceleration, limits_.angular_speed) + 1e-12;
  if (too_fast || turns_too_fast)
    complain(beyond_limits_, "command " + std::to_string(command.seq) + " changes by " +
                                 std::to_string(step.norm() / (cycles * period_)) + " m/s^2 and " +
                                 std::to_string(turn.norm() / (cycles * period_)) +
                                 " rad/s^2, faster than the limit, at " +
                                 std::to_string(linear.norm()) + " m/s");
  if (restrained && linear.norm() > kRounding * last_linear_.norm() + 1e-12)
    complain(beyond_limits_, "command grows while the gate holds it back");
  if (!restrained)
    largest_step_ =
        std::max({largest_step_, step.norm() / (period_ * cycles * limits_.linear_acceleration),
                  turn.norm() / (period_ * cycles * limits_.angular_acceleration)});
  for (int axis = 0; axis < 3 && p_W_E && !restrained; ++axis) {
    const double next = (*p_W_E)[axis] + period_ * linear[axis];
    const bool out = (next > limits_.workspace_upper[axis] && linear[axis] > 0) ||
                     (next < limits_.workspace_lower[axis] && linear[axis] < 0);
    // Decelerating within the acceleration limit, when the workspace limit was not visible.
    const bool braking = linear.norm() < last_linear_.norm();
    if (out && !braking) complain(beyond_limits_, "command leads out of the workspace");
  }
  command_valid_ = command.valid != 0;
  last_linear_ = linear;
  last_angular_ = angular;
}

void Monitor::look_at_health(const bus::Published& message) {
  health_t health;
  if (!read(message, health)) return;
  HealthNote note;
  note.time_ns = message.time_ns;
  note.state = health.state;
  note.not_converged = health.shapes_not_converged;
  note.gate_rejected = health.gate_rejected;
  note.overruns = health.overruns;
  const int inputs = std::min<int>(health.input_count, std::size(health.input_name));
  for (int i = 0; i < inputs; ++i) {
    note.lost += health.lost[i];
    note.rejected += health.rejected[i];
    note.frozen += health.frozen[i];
    const std::string name = bus::get_text(health.input_name[i]);
    const double age = health.age_ms[i];
    if (name == channel::kFtWrench || name == channel::kImu || name == channel::kRobotState)
      note.oldest_ms = std::max(note.oldest_ms, age);
    if (name == channel::kHandState) note.hand_ms = age;
  }
  health_.push_back(note);
}

std::uint64_t Monitor::take_hash() { return std::exchange(hash_, 0); }
std::uint64_t Monitor::take_contact_hash() { return std::exchange(contact_hash_, 0); }

}  // namespace palpate::faults
