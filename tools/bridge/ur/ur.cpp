#include "ur.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "modes.hpp"

namespace palpate::ur_bridge {
namespace {

constexpr std::int64_t kMilli = 1'000'000;
constexpr std::int64_t kStart = 3000 * kMilli;  // ns until a program that has been sent must run
constexpr std::int64_t kEcho = 60 * kMilli;     // ns until a command must come back from it
constexpr std::int64_t kEnd = 300 * kMilli;  // ns in which an ended program may still be reported
constexpr std::int64_t kReported = 100 * kMilli;  // ns that an end counts as a stop, which latches
// The clocks of controller and machine differ by less than this.
constexpr double kDrift = 1e-3;
constexpr double kPayload = 1e-3;  // kg, by which the payload may differ
constexpr int kFirstSeries = 3, kESeries = 5;
constexpr double kFirstSeriesRate = 125;  // 1/s, largest of series 3

void get(PackageReader& reader, Joints& joints) {
  joints.resize(Ur::kJoints);
  for (double& number : joints) number = reader.get<double>();
}

Eigen::Vector3d vector_of(PackageReader& reader) {
  const auto x = reader.get<double>(), y = reader.get<double>(), z = reader.get<double>();
  return {x, y, z};
}

/// Of UR's rotation vector: axis times angle.
Eigen::Matrix3d rotation(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace

std::vector<Variable> Ur::outputs(const Options& options) {
  const std::string first = std::to_string(options.numbers.first);
  const std::string second = std::to_string(options.numbers.first + 1);
  std::vector<Variable> outputs = {{"timestamp", "DOUBLE"},
                                   {"actual_q", "VECTOR6D"},
                                   {"actual_qd", "VECTOR6D"},
                                   {"robot_mode", "INT32"},
                                   {"safety_status_bits", "UINT32"},
                                   {"runtime_state", "UINT32"},
                                   {"output_int_register_" + first, "INT32"},
                                   {"output_int_register_" + second, "INT32"}};
  if (options.torque == Torque::kConstants) outputs.push_back({"actual_current", "VECTOR6D"});
  if (options.torque == Torque::kReported)
    outputs.push_back({"actual_current_as_torque", "VECTOR6D"});
  if (options.wrench) {
    outputs.push_back({"actual_TCP_force", "VECTOR6D"});
    outputs.push_back({"actual_TCP_pose", "VECTOR6D"});
    outputs.push_back({"tcp_offset", "VECTOR6D"});
    outputs.push_back({"payload", "DOUBLE"});
  }
  return outputs;
}

std::vector<Variable> Ur::inputs(const Options& options) {
  const int first = options.numbers.first;
  std::vector<Variable> inputs = {{"input_int_register_" + std::to_string(first), "INT32"},
                                  {"input_int_register_" + std::to_string(first + 1), "INT32"}};
  for (int i = 0; i < kJoints; ++i)
    inputs.push_back({"input_double_register_" + std::to_string(first + i), "DOUBLE"});
  return inputs;
}

Ur::Ur(std::unique_ptr<bridge::Stream> rtde, std::unique_ptr<bridge::Stream> scripts,
       Options options)
    : options_(std::move(options)),
      rtde_(std::move(rtde),
            {outputs(options_), inputs(options_), options_.rate,
             options_.rate > kFirstSeriesRate || options_.wrench ? kESeries : kFirstSeries}),
      sender_(std::move(scripts)) {
  fill_script(options_.script, options_.numbers);
}

void Ur::receive() {
  const std::int64_t now_ns = options_.now_ns();
  const bool was_running = rtde_.is_running();
  rtde_.poll(now_ns);
  sender_.poll();
  if (rtde_.is_running()) return;
  if (was_running || program_ != Program::kNone) end_program(nullptr, now_ns);
  shortest_ns_.reset();
}

std::string Ur::complaint() {
  std::string text = std::exchange(remark_, {});
  return text.empty() ? rtde_.next_remark() : text;
}

bool Ur::foreign_command() { return std::exchange(foreign_, false); }

/// What is sent at a constant rate arrives with a delay of which only the changes can be seen.
bool Ur::is_late(double timestamp, std::int64_t now_ns) {
  const std::int64_t delay_ns = now_ns - static_cast<std::int64_t>(1e9 * timestamp);
  if (shortest_ns_)
    *shortest_ns_ += static_cast<std::int64_t>(kDrift * static_cast<double>(now_ns - state_ns_));
  state_ns_ = now_ns;
  shortest_ns_ = shortest_ns_ ? std::min(*shortest_ns_, delay_ns) : delay_ns;
  const bool is_late = 1e-9 * static_cast<double>(delay_ns - *shortest_ns_) > options_.stale;
  if (is_late) ++late_;
  if (is_late && !is_delayed_) remark_ = "states of the arm arrive late and are rejected";
  is_delayed_ = is_late;
  return is_late;
}

bool Ur::take(bridge::Reading& reading) {
  const std::int64_t now_ns = options_.now_ns();
  while (const std::uint8_t* data = rtde_.take()) {
    PackageReader fields(data, rtde_.output_size());
    const auto timestamp = fields.get<double>();
    get(fields, reading.q);
    get(fields, reading.dq);
    const auto mode = fields.get<std::int32_t>();
    const auto bits = fields.get<std::uint32_t>();
    ProgramState state;
    state.runtime = fields.get<std::uint32_t>();
    state.echo = fields.get<std::int32_t>();
    state.run = fields.get<std::int32_t>();
    reading.tau.setZero(kJoints);
    if (options_.torque != Torque::kNone) get(fields, reading.tau);
    if (options_.torque == Torque::kConstants)
      reading.tau.array() *=
          Eigen::Map<const Eigen::Array<double, kJoints, 1>>(options_.torque_constants.data());
    // Seconds since the controller's start. Others would not be numbers of microseconds.
    if (!(timestamp >= 0 && timestamp < 1e9)) {
      ++late_;
      continue;
    }
    if (is_late(timestamp, now_ns)) continue;
    if (options_.wrench) read_wrench(fields);
    const char* const halted = halt_of(mode, bits);
    follow_program(state, halted != nullptr, now_ns);
    reading.utime = 1 + static_cast<std::int64_t>(1e6 * timestamp);
    reading.arrival_ns = now_ns;
    reading.halted = halted != nullptr ? halted : ended_ != nullptr ? ended_ : paused_;
    return true;
  }
  return false;
}

void Ur::read_wrench(PackageReader& reader) {
  const Eigen::Vector3d force_B = vector_of(reader), torque_B = vector_of(reader);
  vector_of(reader);  // position of the TCP
  const Eigen::Matrix3d R_BT = rotation(vector_of(reader));
  vector_of(reader);  // position of the TCP from the flange
  const Eigen::Matrix3d R_ET = rotation(vector_of(reader));
  const auto payload = reader.get<double>();
  const bool is_other = !(std::abs(payload - options_.wrench->payload) <= kPayload);
  if (is_other && !has_other_payload_)
    remark_ = "no wrench: the controller subtracts a payload of " + std::to_string(payload) +
              " kg; wrench.payload is " + std::to_string(options_.wrench->payload);
  has_other_payload_ = is_other;
  const Eigen::Matrix3d R_EB = R_ET * R_BT.transpose();
  wrench_S_ = {options_.wrench->polarity * (R_EB * force_B),
               options_.wrench->polarity * (R_EB * torque_B)};
  has_wrench_ = !is_other && wrench_S_.force.allFinite() && wrench_S_.torque.allFinite();
}

bool Ur::take(math::Wrench& wrench_S) {
  if (!has_wrench_) return false;
  wrench_S = wrench_S_;
  has_wrench_ = false;
  return true;
}

void Ur::follow_program(const ProgramState& state, bool is_halted, std::int64_t now_ns) {
  const bool is_playing = state.runtime == kPlayingState;
  const bool is_paused = state.runtime >= kPausingState && state.runtime <= kResumingState;
  paused_ = nullptr;
  if (now_ns - program_ns_ > kReported) ended_ = nullptr;
  switch (program_) {
    case Program::kNone:
      if ((is_playing || is_paused) && now_ns - program_ns_ > kEnd) foreign_ = true;
      return;
    case Program::kStarting:
      if (is_playing && state.run == options_.numbers.run) {
        program_ = Program::kRunning;
        echo_ = state.echo;
        echo_ns_ = now_ns;
        sender_.end();
      } else if (is_halted || now_ns - program_ns_ > kStart) {
        end_program("the arm's program does not start (is the controller in remote control?)",
                    now_ns);
      }
      return;
    case Program::kRunning:
      if (state.echo != echo_ || is_paused) echo_ns_ = now_ns;
      echo_ = state.echo;
      if (is_paused)
        paused_ = "the arm's program is paused";
      else if (!is_playing || state.run != options_.numbers.run || now_ns - echo_ns_ > kEcho)
        end_program("the arm's program has ended", now_ns);
      return;
  }
}

void Ur::end_program(const char* why, std::int64_t now_ns) {
  program_ = Program::kNone;
  program_ns_ = now_ns;
  ended_ = why;
  paused_ = nullptr;
  may_start_ = false;
  sender_.end();
}

void Ur::start_program(std::int64_t now_ns) {
  ++options_.numbers.run;
  if (options_.numbers.run <= 0) options_.numbers.run = 1;
  sender_.send(fill_script(options_.script, options_.numbers));
  program_ = Program::kStarting;
  program_ns_ = now_ns;
  ++programs_;
}

void Ur::send(const Joints& dq, std::int64_t /*utime*/) {
  if (!rtde_.is_running()) return;
  if (dq.isZero(0)) {
    may_start_ = true;
  } else if (program_ == Program::kNone && may_start_) {
    start_program(options_.now_ns());
  }
  counter_ = counter_ == 0x7fffffff ? 0 : counter_ + 1;
  PackageWriter& fields = rtde_.begin_inputs();
  fields.put(counter_).put(options_.numbers.run);
  for (const double speed : dq) fields.put(program_ == Program::kRunning ? speed : 0.0);
  rtde_.send_inputs();
}

}  // namespace palpate::ur_bridge
