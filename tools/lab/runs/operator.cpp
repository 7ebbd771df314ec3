#include "tools/lab/runs/operator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"
#include "rt/bus/udpm_url.hpp"
#include "tools/common/interruption.hpp"

namespace palpate::runs {
namespace {

constexpr int kActive = 2, kDegraded = 3;       // health_t.state
constexpr std::int64_t kTargetPeriod = 500000;  // us

template <std::size_t N>
void put(std::uint8_t (&field)[N], const std::string& text) {
  std::memset(field, 0, N);
  std::memcpy(field, text.data(), std::min(text.size(), N - 1));
}

}  // namespace

std::int64_t wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Urls private_urls() {
  const auto url = [] { return bus::private_url().text(); };
  return {url(), url(), url()};
}

Operator::Operator(const Urls& urls, const std::optional<bus::Key>& key)
    : control_(bus::make_lcm_bus(urls.control)),
      housekeeping_(bus::make_lcm_bus(urls.housekeeping)),
      healths_(*housekeeping_, channel::kHealth, 30),
      events_(*housekeeping_, channel::kComponentEvent, 200),
      features_(*control_, channel::kFeature, 2),
      twists_(*control_, channel::kTwistCommand, 200),
      commands_(*control_, channel::kComponentCommand),
      targets_(*control_, channel::kShapeTarget),
      session_(wall_clock()),
      command_sealer_(channel::kComponentCommand, {key, session_}),
      target_sealer_(channel::kShapeTarget, {key, session_}) {
  control_->start_without_thread();
  housekeeping_->start_without_thread();
}

void Operator::take(const component_event_t& event) {
  if (std::string(bus::get_text(event.event)) == "refused") refusal_ = bus::get_text(event.reason);
}

void Operator::take(const feature_t& feature) {
  following_ = target_ && feature.revision == target_->revision;
  if (following_ && feature.error_count >= 3)
    estimated_error_ = std::hypot(feature.error[0], feature.error[1], feature.error[2]);
}

void Operator::take(const twist_command_t& command) {
  const double* twist = command.twist;
  const bool moving = std::any_of(twist, twist + 6, [](double v) { return std::abs(v) > 1e-6; });
  if (moving || !following_)
    still_since_ = 0;
  else if (still_since_ == 0)
    still_since_ = wall_clock();
}

void Operator::take_all() {
  std::int64_t arrival_ns = 0;
  health_t health;
  while (healths_.take(health, arrival_ns)) health_ = health;
  component_event_t event;
  while (events_.take(event, arrival_ns)) take(event);
  feature_t feature;
  while (features_.take(feature, arrival_ns)) take(feature);
  twist_command_t command;
  while (twists_.take(command, arrival_ns)) take(command);
}

void Operator::spin(double seconds) {
  constexpr std::int64_t kLongestWait = 20'000;  // us
  const std::int64_t end = wall_clock() + static_cast<std::int64_t>(seconds * 1e6);
  for (std::int64_t now = wall_clock(); now < end; now = wall_clock()) {
    common::throw_if_interrupted();
    if (target_ && now - target_sent_ >= kTargetPeriod) {
      target_->utime = now;
      target_->seq = seq_++;
      target_sealer_.put(*target_, now);
      targets_.publish(*target_);
      target_sent_ = now;
    }
    // A daemon that runs says something on the control URL a thousand times a second.
    housekeeping_->receive(0);
    control_->receive(1000 * std::min(kLongestWait, end - now));
    take_all();
  }
}

void Operator::send_event(const std::string& event) {
  component_command_t command = {};
  command.utime = wall_clock();
  command.seq = seq_++;
  command.session = session_;
  put(command.slot, "all");
  put(command.event, event);
  command_sealer_.put(command, command.utime);
  commands_.publish(command);
}

void Operator::set_target(const ControlTarget& wanted) {
  shape_target_t target = {};
  target.session = session_;
  target.revision = target_ ? target_->revision + 1 : 1;
  target.chunk = 0;
  target.chunks = 1;
  put(target.kind, wanted.kind);
  target.point_count = static_cast<int>(wanted.rest_points.size());
  for (int i = 0; i < target.point_count; ++i)
    std::copy_n(wanted.rest_points[i].data(), 3, target.rest_points[i]);
  target.value_count = static_cast<int>(wanted.values.size());
  std::copy_n(wanted.values.data(), target.value_count, target.values);
  target_ = target;
  target_sent_ = 0;
  following_ = false;
  still_since_ = 0;
}

bool Operator::is_running() const {
  return health_ && (health_->state == kActive || health_->state == kDegraded);
}

bool Operator::is_active() const { return health_ && health_->state == kActive; }

bool Operator::has_robot_state() const {
  if (!health_) return false;
  const int inputs = std::min<int>(health_->input_count, std::size(health_->input_name));
  for (int i = 0; i < inputs; ++i)
    if (std::string(bus::get_text(health_->input_name[i])) == channel::kRobotState)
      return health_->received[i] > 0;
  return false;
}

double Operator::settled() const {
  if (still_since_ == 0) return 0;
  return static_cast<double>(wall_clock() - still_since_) * 1e-6;
}

}  // namespace palpate::runs
