#include "tests/unit/tools/bridge/ur/mock_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <regex>
#include <sstream>

namespace palpate::ur_bridge {
namespace {

constexpr std::int64_t kNotYet = std::numeric_limits<std::int64_t>::max();

void append(std::vector<std::uint8_t>& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void append_double(std::vector<std::uint8_t>& bytes, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, 8);
  append(bytes, bits, 8);
}

std::uint64_t number(const std::vector<std::uint8_t>& bytes, std::size_t at, int size) {
  std::uint64_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | bytes.at(at + static_cast<std::size_t>(i));
  return value;
}

std::string type_of(const std::string& name) {
  static const std::map<std::string, std::string> types{{"timestamp", "DOUBLE"},
                                                        {"actual_q", "VECTOR6D"},
                                                        {"actual_qd", "VECTOR6D"},
                                                        {"robot_mode", "INT32"},
                                                        {"runtime_state", "UINT32"},
                                                        {"safety_status_bits", "UINT32"},
                                                        {"actual_current", "VECTOR6D"},
                                                        {"actual_TCP_force", "VECTOR6D"},
                                                        {"actual_TCP_pose", "VECTOR6D"},
                                                        {"tcp_offset", "VECTOR6D"},
                                                        {"payload", "DOUBLE"}};
  if (name.find("put_int_register_") != std::string::npos) return "INT32";
  if (name.find("put_double_register_") != std::string::npos) return "DOUBLE";
  const auto found = types.find(name);
  return found == types.end() ? "NOT_FOUND" : found->second;
}

int size_in_bytes(const std::string& type) {
  return type == "VECTOR6D" ? 48 : type == "DOUBLE" ? 8 : 4;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

std::string register_name(const char* kind, int index) { return kind + std::to_string(index); }

}  // namespace

MockController::MockController(const driver::Joints& q, int period_ms)
    : period_ms_(period_ms), q_(q) {
  dq_.setZero(6);
  wanted_.setZero(6);
}

std::unique_ptr<bridge::Stream> MockController::connect(Pipe& pipe, const std::string& name) {
  return std::make_unique<bridge::MemoryStream>(pipe, now_ns_, name);
}

void MockController::violate(const std::string& what) {
  if (violation_.empty()) violation_ = what;
}

void MockController::restart() {
  rtde_ = {};
  script_ = {};
  incoming_.clear();
  text_.clear();
  registers_.clear();
  born_ns_ = now_ns_;
  phase_ = 0;
  stop_program();
}

void MockController::release_stops() {
  is_emergency_stopped = is_protectively_stopped = is_paused = false;
  robot_mode = 7;
}

void MockController::run_other_program() {
  runs_.reset();
  runtime_ = 2;
}

void MockController::answer(std::uint8_t type, const std::vector<std::uint8_t>& fields) {
  std::vector<std::uint8_t> package;
  append(package, fields.size() + 3, 2);
  package.push_back(type);
  package.insert(package.end(), fields.begin(), fields.end());
  const std::int64_t arrival_ns = is_absent ? kNotYet : now_ns_ + delay_ns;
  for (const std::uint8_t byte : package) rtde_.to_client.emplace_back(arrival_ns, byte);
}

void MockController::setup(std::uint8_t type, const std::string& names,
                           std::vector<Recipe>& recipe) {
  recipe.clear();
  std::string types;
  bool is_sound = true;
  for (const std::string& name : split(names)) {
    std::string one = type_of(name);
    if (type == 'I' && has_registers_in_use) one = "IN_USE";
    if (has_other_type && name == "actual_qd") one = "VECTOR6INT32";
    recipe.push_back({name, size_in_bytes(one), name.find("_register_") != std::string::npos});
    is_sound = is_sound && one != "NOT_FOUND" && one != "IN_USE";
    types += (types.empty() ? "" : ",") + one;
  }
  std::vector<std::uint8_t> fields{static_cast<std::uint8_t>(is_sound ? (type == 'I' ? 7 : 3) : 0)};
  fields.insert(fields.end(), types.begin(), types.end());
  answer(type, fields);
}

void MockController::take_inputs(const std::vector<std::uint8_t>& fields) {
  std::size_t at = 1;
  if (fields.empty() || fields[0] != 7) return violate("inputs of another recipe");
  for (const auto& [name, size, is_register] : inputs_) {
    if (at + static_cast<std::size_t>(size) > fields.size()) return violate("inputs are too short");
    const std::uint64_t bits = number(fields, at, size);
    double value = static_cast<std::int32_t>(bits);
    if (size == 8) std::memcpy(&value, &bits, 8);
    if (!std::isfinite(value)) violate("an input is not finite");
    registers_[name] = value;
    at += static_cast<std::size_t>(size);
  }
  if (at != fields.size()) violate("inputs are too long");
  ++commands_;
}

void MockController::handle(std::uint8_t type, const std::vector<std::uint8_t>& fields) {
  const std::string text(fields.begin(), fields.end());
  if (type == 'V' && phase_ == 0) {
    const bool is_known = fields.size() == 2 && number(fields, 0, 2) == 2;
    if (!is_known) violate("another version");
    if (is_known && !refuses_version) phase_ = 1;
    return answer('V', {static_cast<std::uint8_t>(is_known && !refuses_version)});
  }
  if (type == 'v' && phase_ == 1 && fields.empty()) {
    std::vector<std::uint8_t> version;
    for (const std::uint32_t part : {major, 12U, 0U, 1234U}) append(version, part, 4);
    return answer('v', version);
  }
  if (type == 'O' && phase_ == 1 && fields.size() > 8) {
    const std::uint64_t bits = number(fields, 0, 8);
    std::memcpy(&rate_, &bits, 8);
    if (rate_ != 1000 / period_ms_) violate("another rate");
    phase_ = 2;
    return setup('O', text.substr(8), outputs_);
  }
  if (type == 'I' && phase_ == 2) {
    phase_ = 3;
    return setup('I', text, inputs_);
  }
  if (type == 'S' && phase_ == 3 && fields.empty()) {
    phase_ = 4;
    return answer('S', {1});
  }
  if (type == 'U' && phase_ == 4) return take_inputs(fields);
  violate("a package of type " + std::to_string(type) + " in phase " + std::to_string(phase_));
}

void MockController::serve() {
  if (is_absent) return;  // what has been sent arrives later, in both directions
  for (auto& [arrival_ns, byte] : rtde_.to_client)
    if (arrival_ns == kNotYet) arrival_ns = now_ns_;
  for (Pipe* pipe : {&rtde_, &script_})
    if (pipe->is_wanted && !pipe->is_open) {
      pipe->is_open = true;
      if (pipe == &rtde_) phase_ = 0, incoming_.clear();
      if (pipe == &script_) text_.clear();
    }
  for (const auto& [time, byte] : rtde_.to_server) incoming_.push_back(byte);
  rtde_.to_server.clear();
  for (const auto& [time, byte] : script_.to_server) text_ += static_cast<char>(byte);
  script_.to_server.clear();
  if (script_.is_open) script_.to_client.emplace_back(now_ns_, 0);  // its state, which is not read
  while (incoming_.size() >= 3) {
    const std::size_t size = number(incoming_, 0, 2);
    if (size < 3) return violate("a size");
    if (incoming_.size() < size) break;
    const std::uint8_t type = incoming_[2];
    const std::vector<std::uint8_t> fields(incoming_.begin() + 3,
                                           incoming_.begin() + static_cast<std::ptrdiff_t>(size));
    incoming_.erase(incoming_.begin(), incoming_.begin() + static_cast<std::ptrdiff_t>(size));
    handle(type, fields);
  }
  take_script();
}

/// The numbers that fill_script has written.
void MockController::take_script() {
  if (text_.find("\nend\n") == std::string::npos) return;
  const auto find = [this](const std::string& pattern) {
    std::smatch match;
    if (std::regex_search(text_, match, std::regex(pattern + "([-0-9.]+)")))
      return std::stod(match[1]);
    violate("the script has no " + pattern);
    return 0.0;
  };
  Script script;
  script.first = static_cast<int>(find("first = "));
  script.run = static_cast<int>(find("run = "));
  script.acceleration = find("acceleration = ");
  script.most_speed = find("most_speed = ");
  script.most_missed = static_cast<int>(std::ceil(1e3 * find("most_missed = ") / period_ms_));
  script.begins_in_ms = kStartUp;
  text_.clear();
  if (!is_remote || is_emergency_stopped || is_protectively_stopped || robot_mode != 7) return;
  ++programs_;
  runs_ = script;
  runtime_ = 2;
}

/// As follow_velocities.script, for one period.
void MockController::run_script() {
  const auto input = [this](const char* kind, int index) {
    return registers_[register_name(kind, index)];
  };
  Script& script = *runs_;
  if (!script.has_begun) {
    script.begins_in_ms -= period_ms_;
    if (script.begins_in_ms > 0) return;
    script.has_begun = true;
    script.counter = static_cast<std::int32_t>(input("input_int_register_", script.first));
    registers_[register_name("output_int_register_", script.first + 1)] = script.run;
  }
  const auto now = static_cast<std::int32_t>(input("input_int_register_", script.first));
  script.missed = now == script.counter ? script.missed + 1 : 0;
  script.counter = now;
  if (input("input_int_register_", script.first + 1) != script.run) script.stops = true;
  driver::Joints wanted(6);
  for (int i = 0; i < 6; ++i) {
    wanted[i] = input("input_double_register_", script.first + i);
    if (std::abs(wanted[i]) > script.most_speed) {
      violate("a speed above the script's limit");
      script.stops = true;
    }
  }
  script.stops = script.stops || script.missed >= script.most_missed;
  if (script.stops) wanted.setZero();
  move(wanted, script.acceleration);
  registers_[register_name("output_int_register_", script.first)] = script.counter;
  if (script.stops && wanted_.isZero(0)) {
    registers_[register_name("output_int_register_", script.first + 1)] = 0;
    stop_program();
  }
}

void MockController::move(const driver::Joints& wanted, double acceleration) {
  const double step = 1e-3 * period_ms_ * acceleration;
  wanted_ += (wanted - wanted_).cwiseMax(-step).cwiseMin(step);
}

/// Numbers of an output, at most six.
void MockController::read(const std::string& name, std::array<double, 6>& values) const {
  const auto other = added_.find(name);
  if (other != added_.end()) std::copy(other->second.begin(), other->second.end(), values.begin());
  if (name == "timestamp") values[0] = 1e-9 * static_cast<double>(now_ns_ - born_ns_);
  if (name == "actual_q") std::copy_n(q_.data(), 6, values.begin());
  if (name == "actual_q" && has_nan) values[2] = std::numeric_limits<double>::quiet_NaN();
  if (name == "actual_qd") std::copy_n(dq_.data(), 6, values.begin());
  if (name == "robot_mode") values[0] = robot_mode;
  if (name == "runtime_state") values[0] = runtime_;
  if (name == "safety_status_bits")
    values[0] = is_emergency_stopped ? 192 : is_protectively_stopped ? 4 : 1;
}

void MockController::publish() {
  std::vector<std::uint8_t> fields{3};
  for (const Recipe& output : outputs_) {
    std::array<double, 6> values{};
    if (output.is_register)
      values[0] = registers_[output.name];
    else
      read(output.name, values);
    if (output.size == 4)
      append(fields, static_cast<std::uint32_t>(static_cast<std::int64_t>(values[0])), 4);
    else
      for (int i = 0; i < output.size / 8; ++i)
        append_double(fields, values[static_cast<std::size_t>(i)]);
  }
  answer('U', fields);
}

void MockController::step(std::int64_t now_ns) {
  now_ns_ = now_ns;
  serve();
  if (now_ns / 1'000'000 % period_ms_ != 0) return;
  const bool is_stopped = is_emergency_stopped || is_protectively_stopped;
  if (is_emergency_stopped) {
    robot_mode = 3;
    if (runtime_ == 2) stop_program();
  }
  if (is_protectively_stopped) is_paused = true;
  if (runtime_ == 2 && is_paused) runtime_ = 4;
  if (runtime_ == 4 && !is_paused) runtime_ = 2;
  if (runs_ && runtime_ == 2)
    run_script();
  else
    move(driver::Joints::Zero(6), is_stopped ? kBrakes : 10);
  dq_ += std::min(1.0, 1e-3 * period_ms_ / kLag) * (wanted_ - dq_);
  q_ += 1e-3 * period_ms_ * dq_;
  if (phase_ == 4 && rtde_.is_open && !is_mute) publish();
}

}  // namespace palpate::ur_bridge
