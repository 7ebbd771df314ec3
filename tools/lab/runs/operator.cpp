#include "tools/lab/runs/operator.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <palpate/component_command_t.hpp>
#include <stdexcept>

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
    : control_(urls.control),
      housekeeping_(urls.housekeeping),
      session_(wall_clock()),
      command_sealer_("COMPONENT_COMMAND", {key, session_}),
      target_sealer_("SHAPE_TARGET", {key, session_}) {
  for (const auto& [lcm, url] :
       {std::pair{&control_, urls.control}, std::pair{&housekeeping_, urls.housekeeping}})
    if (!lcm->good())
      throw std::runtime_error(
          "cannot open " + url +
          "; is there a multicast route? ip link set lo multicast on; ip route "
          "add 224.0.0.0/4 dev lo");
  housekeeping_.subscribe("HEALTH", &Operator::on_health, this);
  housekeeping_.subscribe("COMPONENT_EVENT", &Operator::on_event, this);
  control_.subscribe("FEATURE", &Operator::on_feature, this)->setQueueCapacity(2);
  control_.subscribe("TWIST_COMMAND", &Operator::on_command, this)->setQueueCapacity(200);
}

void Operator::on_health(const lcm::ReceiveBuffer*, const std::string&, const health_t* message) {
  health_ = *message;
}

void Operator::on_event(const lcm::ReceiveBuffer*, const std::string&,
                        const component_event_t* message) {
  const std::string event(reinterpret_cast<const char*>(message->event));
  if (event == "refused") refusal_ = reinterpret_cast<const char*>(message->reason);
}

void Operator::on_feature(const lcm::ReceiveBuffer*, const std::string&, const feature_t* message) {
  following_ = target_ && message->revision == target_->revision;
  if (following_ && message->error_count >= 3)
    estimated_error_ = std::hypot(message->error[0], message->error[1], message->error[2]);
}

void Operator::on_command(const lcm::ReceiveBuffer*, const std::string&,
                          const twist_command_t* message) {
  const double* twist = message->twist;
  const bool moving = std::any_of(twist, twist + 6, [](double v) { return std::abs(v) > 1e-6; });
  if (moving || !following_)
    still_since_ = 0;
  else if (still_since_ == 0)
    still_since_ = wall_clock();
}

void Operator::spin(double seconds) {
  const std::int64_t end = wall_clock() + static_cast<std::int64_t>(seconds * 1e6);
  for (std::int64_t now = wall_clock(); now < end; now = wall_clock()) {
    common::throw_if_interrupted();
    if (target_ && now - target_sent_ >= kTargetPeriod) {
      target_->utime = now;
      target_->seq = seq_++;
      target_sealer_.put(*target_, now);
      control_.publish("SHAPE_TARGET", &*target_);
      target_sent_ = now;
    }
    pollfd sockets[2] = {{control_.getFileno(), POLLIN, 0}, {housekeeping_.getFileno(), POLLIN, 0}};
    const int timeout = static_cast<int>(std::min<std::int64_t>(20, (end - now) / 1000 + 1));
    if (::poll(sockets, 2, timeout) <= 0) continue;
    if (sockets[0].revents & POLLIN) control_.handleTimeout(0);
    if (sockets[1].revents & POLLIN) housekeeping_.handleTimeout(0);
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
  control_.publish("COMPONENT_COMMAND", &command);
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
  for (int i = 0; i < health_->input_count; ++i)
    if (std::strcmp(reinterpret_cast<const char*>(health_->input_name[i]), "ROBOT_STATE") == 0)
      return health_->received[i] > 0;
  return false;
}

double Operator::settled() const {
  if (still_since_ == 0) return 0;
  return static_cast<double>(wall_clock() - still_since_) * 1e-6;
}

}  // namespace palpate::runs
