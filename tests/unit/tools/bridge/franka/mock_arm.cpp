#include "tests/unit/tools/bridge/franka/mock_arm.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace palpate::franka_bridge {
namespace {

constexpr double kMs = 1e-3;    // s
constexpr double kLag = 0.002;  // s, of the joints
constexpr std::int64_t kNotYet = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t kVelocityLimits = 13, kVelocityStep = 14, kAccelerationStep = 15;
constexpr std::size_t kCommunication = 25, kJointReflex = 6;
constexpr std::uint32_t kStopMove = 2, kGetRobotModel = 11;

class MemoryDatagrams final : public Datagrams {
 public:
  MemoryDatagrams(MockArm::Network& network, const std::int64_t& now_ns)
      : network_(network), now_ns_(now_ns) {}

  std::uint16_t port() const override { return 12345; }
  int receive(std::uint8_t* to, int size) override {
    auto& waiting = network_.to_client;
    if (waiting.empty() || waiting.front().arrival_ns > now_ns_) return -1;
    const std::vector<std::uint8_t> bytes = std::move(waiting.front().bytes);
    waiting.pop_front();
    const int count = static_cast<int>(bytes.size());
    std::copy_n(bytes.begin(), std::min(count, size), to);
    return count;
  }
  void send(const std::uint8_t* data, int size) override {
    network_.to_server.push_back({now_ns_, std::vector<std::uint8_t>(data, data + size)});
  }
  void wait(std::int64_t /*until_ns*/) override {}

 private:
  MockArm::Network& network_;
  const std::int64_t& now_ns_;
};

template <class Numbers>
void put_floats(std::vector<std::uint8_t>& bytes, const Numbers& numbers) {
  for (const double number : numbers) {
    const auto narrow = static_cast<float>(number);
    const auto* data = reinterpret_cast<const std::uint8_t*>(&narrow);
    bytes.insert(bytes.end(), data, data + 4);
  }
}

void put_zeros(std::vector<std::uint8_t>& bytes, int floats) {
  bytes.resize(bytes.size() + 4 * static_cast<std::size_t>(floats));
}

template <class Number>
Number number_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  Number number{};
  if (at + sizeof(number) <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

constexpr std::array<double, 16> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

}  // namespace

MockArm::MockArm(const driver::Joints& q) : X_FE(kIdentity), X_EK(kIdentity), q_(q) {
  dq_.setZero(kJoints);
}

std::unique_ptr<bridge::Stream> MockArm::stream() {
  return std::make_unique<bridge::MemoryStream>(network_.tcp, now_ns_, "mock:1337");
}

std::unique_ptr<Datagrams> MockArm::datagrams() {
  return std::make_unique<MemoryDatagrams>(network_, now_ns_);
}

void MockArm::violate(const std::string& what) {
  if (violation_.empty()) violation_ = what;
}

void MockArm::restart() {
  network_ = {};
  incoming_.clear();
  is_connected_ = is_moving_ = false;
  starts_in_ms_ = -1;
  id_ = 0;
  mode_ = RobotMode::kIdle;
}

void MockArm::collide() { reflex(kJointReflex); }

void MockArm::release() {
  is_user_stopped = is_moved_by_others = false;
  if (!is_moving_) mode_ = RobotMode::kIdle;
}

void MockArm::answer(std::uint32_t request, std::uint32_t number,
                     const std::vector<std::uint8_t>& payload) {
  const std::array<std::uint32_t, 3> header{request, number,
                                            static_cast<std::uint32_t>(12 + payload.size())};
  std::vector<std::uint8_t> bytes(12);
  std::memcpy(bytes.data(), header.data(), 12);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  const std::int64_t arrival_ns = is_absent ? kNotYet : now_ns_ + delay_ns;
  for (const std::uint8_t byte : bytes) network_.tcp.to_client.emplace_back(arrival_ns, byte);
}

void MockArm::begin_motion(std::uint32_t number) {
  const auto move = static_cast<std::uint32_t>(Request::kMove);
  if (refuses_moves != 0) return answer(move, number, {refuses_moves});
  if (mode_ != RobotMode::kIdle) return answer(move, number, {5});
  starts_in_ms_ = kStartUp;
  motion_number_ = number;
  ++motions_;
  answer(move, number, {kMotionStarted});
}

void MockArm::end_motion(RobotMode mode, std::uint8_t status) {
  mode_ = mode;
  if (!is_moving_ && starts_in_ms_ < 0) return;
  is_moving_ = is_reported_ = false;
  starts_in_ms_ = -1;
  if (status == 0) ++ended_;
  answer(static_cast<std::uint32_t>(Request::kMove), motion_number_, {status});
}

void MockArm::reflex(std::size_t error) {
  reason_ = {};
  reason_[error] = true;
  ++reflexes_;
  end_motion(RobotMode::kReflex, 8);
}

void MockArm::handle(const Header& header, const std::vector<std::uint8_t>& payload) {
  if (!is_connected_) {
    if (header.request != 0 || payload.size() != 4) return violate("not a request to connect");
    if (number_at<std::uint16_t>(payload, 0) != kFciVersion) violate("another version");
    network_.client_port = number_at<std::uint16_t>(payload, 2);
    is_connected_ = version == kFciVersion;
    return answer(0, header.number,
                  {static_cast<std::uint8_t>(is_connected_ ? 0 : 1),
                   static_cast<std::uint8_t>(version), static_cast<std::uint8_t>(version >> 8)});
  }
  switch (header.request) {
    case static_cast<std::uint32_t>(Request::kMove):
      if (payload.size() != 113 || number_at<std::uint32_t>(payload, 0) != 0 ||
          number_at<std::uint32_t>(payload, 4) != 1 || number_at<double>(payload, 8) <= 0 ||
          std::any_of(payload.begin() + 56, payload.end(), [](int byte) { return byte != 0; }))
        return violate("a request to move with other modes or of another size");
      return begin_motion(header.number);
    case static_cast<std::uint32_t>(Request::kAutomaticErrorRecovery): {
      if (!payload.empty()) violate("a request to recover with a payload");
      const bool may = mode_ == RobotMode::kReflex && speed() < 1e-3;
      if (may) mode_ = RobotMode::kIdle;
      return answer(header.request, header.number, {static_cast<std::uint8_t>(may ? 0 : 1)});
    }
    case kStopMove:
      end_motion(RobotMode::kIdle, 2);
      return answer(header.request, header.number, {0});
    case kGetRobotModel: {
      std::vector<std::uint8_t> text{0};
      text.insert(text.end(), urdf.begin(), urdf.end());
      return answer(header.request, header.number, text);
    }
    default:
      violate("a request of kind " + std::to_string(header.request));
  }
}

void MockArm::serve() {
  bridge::Pipe& tcp = network_.tcp;
  for (auto& [arrival_ns, byte] : tcp.to_client)
    if (arrival_ns == kNotYet) arrival_ns = now_ns_;
  if (tcp.is_wanted && !tcp.is_open) {
    tcp.is_wanted = !is_taken;
    tcp.is_open = !is_taken;
    incoming_.clear();
    is_connected_ = false;
    if (is_moving_) reflex(kCommunication);
  }
  if (!tcp.is_open) is_connected_ = false;
  for (const auto& [time, byte] : tcp.to_server) incoming_.push_back(byte);
  tcp.to_server.clear();
  while (incoming_.size() >= static_cast<std::size_t>(kHeaderSize)) {
    const Header header = read_header(incoming_.data());
    if (header.size < 12) return violate("a size");
    if (incoming_.size() < header.size) return;
    const auto end = incoming_.begin() + static_cast<std::ptrdiff_t>(header.size);
    const std::vector<std::uint8_t> payload(incoming_.begin() + kHeaderSize, end);
    incoming_.erase(incoming_.begin(), end);
    handle(header, payload);
  }
}

/// The command `dq`, in time.
void MockArm::obey(const Seven& dq, bool is_last) {
  const Limits& limits = fr3_limits();
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!std::isfinite(dq[i])) return violate("a velocity is not finite");
    const Limits::Speed& speed = limits.speed[i];
    const double left =
        dq[i] > 0 ? speed.upper - q_[static_cast<int>(i)] : q_[static_cast<int>(i)] - speed.lower;
    const double most =
        std::min(speed.most, std::sqrt(speed.slope * std::max(0.0, left)) - speed.offset);
    const double ddq = (dq[i] - dq_d_[i]) / kMs;
    if (std::abs(dq[i]) > std::max(0.0, most)) return reflex(kVelocityLimits);
    if (std::abs(ddq) > limits.acceleration) return reflex(kVelocityStep);
    if (std::abs(ddq - ddq_d_[i]) / kMs > limits.jerk) return reflex(kAccelerationStep);
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    ddq_d_[i] = (dq[i] - dq_d_[i]) / kMs;
    dq_d_[i] = dq[i];
  }
  if (!is_last) return;
  if (std::any_of(dq.begin(), dq.end(), [](double one) { return std::abs(one) > 1e-4; }))
    violate("a motion ends at speed");
  end_motion(RobotMode::kIdle, 0);
}

/// As if the acceleration had remained.
void MockArm::extrapolate() {
  if (++lost_ >= kMostLost) return reflex(kCommunication);
  for (std::size_t i = 0; i < kJoints; ++i) dq_d_[i] += kMs * ddq_d_[i];
}

void MockArm::take_commands() {
  bool is_answered = false;
  for (const Datagram& datagram : network_.to_server) {
    if (is_deaf) continue;
    ++commands_;
    if (datagram.bytes.size() != static_cast<std::size_t>(kCommandSize)) {
      violate("a command of another size");
      continue;
    }
    // Those of a motion that has ended meanwhile are late.
    if (motions_ == 0) violate("a command without a motion");
    if (number_at<std::uint64_t>(datagram.bytes, 0) != id_ || !is_moving_ || !is_reported_)
      continue;
    Seven dq{};
    std::memcpy(dq.data(), datagram.bytes.data() + 64, sizeof(dq));
    is_answered = true;
    lost_ = 0;
    obey(dq, datagram.bytes[313] != 0);
  }
  network_.to_server.clear();
  if (is_moving_ && is_reported_ && !is_answered) extrapolate();
}

void MockArm::brake() {
  for (double& speed : dq_d_) speed -= std::clamp(speed, -kMs * kBrakes, kMs * kBrakes);
  ddq_d_ = {};
}

void MockArm::publish() {
  std::vector<std::uint8_t> bytes(8);
  std::memcpy(bytes.data(), &id_, 8);
  put_floats(bytes, kIdentity);  // O_T_EE
  put_floats(bytes, kIdentity);  // O_T_EE_d
  put_floats(bytes, X_FE);
  put_floats(bytes, X_EK);
  put_floats(bytes, kIdentity);  // F_T_NE
  put_floats(bytes, kIdentity);  // NE_T_EE
  put_floats(bytes, std::array<double, 1>{end_effector});
  put_zeros(bytes, 12);  // its inertia and centre
  put_floats(bytes, std::array<double, 1>{load});
  put_zeros(bytes, 12 + 4);  // and the elbow
  put_floats(bytes, tau_J);
  put_zeros(bytes, 14);  // tau_J_d, dtau_J
  std::array<double, kJoints> q{}, dq{};
  std::copy_n(q_.data(), kJoints, q.begin());
  std::copy_n(dq_.data(), kJoints, dq.begin());
  if (has_nan) q[2] = std::numeric_limits<double>::quiet_NaN();
  put_floats(bytes, q);
  put_floats(bytes, q);  // q_d
  put_floats(bytes, dq);
  put_floats(bytes, dq_d_);
  put_floats(bytes, ddq_d_);
  put_zeros(bytes, 26);  // contacts and collisions
  put_floats(bytes, tau_ext);
  put_floats(bytes, F_K);  // O_F_ext_hat_K, if the axes are the same
  put_floats(bytes, F_K);
  put_zeros(bytes, 6 + 3 + 6);   // O_dP_EE_d, O_ddP_O, the commanded elbow
  put_floats(bytes, kIdentity);  // O_T_EE_c
  put_zeros(bytes, 12);          // its derivatives
  put_floats(bytes, q);          // theta
  put_floats(bytes, dq);
  put_zeros(bytes, 36);  // accelerometers
  bytes.push_back(is_moving_ ? kJointVelocityGenerator : kIdleGenerator);
  bytes.push_back(is_moving_ ? 0 : 3);
  for (int copy = 0; copy < 2; ++copy)
    for (std::size_t i = 0; i < kErrors; ++i)
      bytes.push_back((mode_ == RobotMode::kReflex && reason_[i]) || extra_errors[i] ? 1 : 0);
  bytes.push_back(static_cast<std::uint8_t>(is_moved_by_others ? RobotMode::kMove : mode_));
  put_floats(bytes, std::array<double, 1>{is_moving_ ? 1.0 : 0.0});
  if (bytes.size() != static_cast<std::size_t>(kStateSize)) violate("the mock is wrong");
  if (is_cut_short) bytes.pop_back();
  is_reported_ = is_moving_;
  network_.to_client.push_back({now_ns_ + delay_ns, std::move(bytes)});
}

void MockArm::step(std::int64_t now_ns) {
  now_ns_ = now_ns;
  if (is_absent)
    network_.to_server.clear();
  else
    serve();
  take_commands();
  if (starts_in_ms_ > 0 && --starts_in_ms_ == 0) {
    starts_in_ms_ = -1;
    is_moving_ = true;
    mode_ = RobotMode::kMove;
    lost_ = 0;
  }
  if (is_user_stopped) end_motion(RobotMode::kUserStopped, 9);
  if (is_moved_by_others) end_motion(RobotMode::kIdle, 2);
  if (!is_moving_) brake();
  const Eigen::Map<const Eigen::Matrix<double, kJoints, 1>> wanted(dq_d_.data());
  dq_ += std::min(1.0, kMs / kLag) * (wanted - dq_);
  q_ += kMs * dq_;
  ++id_;
  if (is_connected_ && !is_absent && !is_mute) publish();
}

}  // namespace palpate::franka_bridge
