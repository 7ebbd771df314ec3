#include "fast_arm.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace fast_peer {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t system_ns() {
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

/// An encoded message that begins with a header; `put` adds the rest.
template <class Put>
Bytes encoded(std::int64_t stamp_ns, const Put& put) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << static_cast<std::int32_t>(stamp_ns / kSecond)
      << static_cast<std::uint32_t>(stamp_ns % kSecond) << std::string("fast");
  put(cdr);
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(buffer.getBuffer());
  return Bytes(bytes, bytes + cdr.getSerializedDataLength());
}

/// Reads an encoded message.
class Decoder {
 public:
  explicit Decoder(Bytes message)
      : message_(std::move(message)),
        buffer_(reinterpret_cast<char*>(message_.data()), message_.size()),
        cdr(buffer_, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR) {
    cdr.read_encapsulation();
  }

 private:
  Bytes message_;
  FastBuffer buffer_;

 public:
  Cdr cdr;
};

/// ns.
std::int64_t read_header(Cdr& cdr) {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame;
  cdr >> sec >> nanosec >> frame;
  return kSecond * sec + nanosec;
}

std::string quantiles(std::vector<double>& sample) {
  std::ostringstream text;
  std::sort(sample.begin(), sample.end());
  for (const double share : {0.5, 0.99, 0.999}) {
    const auto place = static_cast<std::size_t>(share * static_cast<double>(sample.size()));
    text << (sample.empty() ? std::nan("") : sample[std::min(place, sample.size() - 1)]) << ' ';
  }
  text << (sample.empty() ? std::nan("") : sample.back()) << ' ' << sample.size();
  sample.clear();
  return text.str();
}

}  // namespace

FastArm::FastArm(RawDds& dds, const Options& options)
    : dds_(dds), options_(options), q_(options.q), dq_(options.q.size(), 0) {
  dds_.add_writer("rt/" + options.states, "sensor_msgs::msg::dds_::JointState_", false);
  dds_.add_reader("rt/" + options.commands,
                  options.takes_twists ? "geometry_msgs::msg::dds_::TwistStamped_"
                                       : "std_msgs::msg::dds_::Float64MultiArray_",
                  true, [this](const Bytes& message) { take_command(message); });
  if (!options.wrench.empty()) {
    constexpr const char* kType = "geometry_msgs::msg::dds_::WrenchStamped_";
    dds_.add_writer("rt/" + options.wrench, kType, false);
    dds_.add_reader("rt/" + options.compensated, kType, false,
                    [this](const Bytes& message) { take_wrench(message); });
  }
  thread_ = std::thread([this] { run(); });
}

FastArm::~FastArm() {
  ended_ = true;
  thread_.join();
}

void FastArm::take_command(const Bytes& message) {
  const std::int64_t now_ns = system_ns();
  Decoder decoder(message);
  Cdr& cdr = decoder.cdr;
  std::vector<double> numbers(6);
  if (options_.takes_twists) {
    read_header(cdr);
    for (double& number : numbers) cdr >> number;
  } else {
    std::uint32_t dimensions = 0, offset = 0;
    cdr >> dimensions >> offset >> numbers;  // without dimensions
    if (dimensions != 0 || numbers.size() != q_.size())
      throw std::runtime_error("a strange command");
  }
  const std::lock_guard lock(mutex_);
  ++commands_;
  speed_ = 0;
  for (const double number : numbers) speed_ = std::max(speed_, std::abs(number));
  if (!options_.takes_twists) dq_ = numbers;
  for (const std::int64_t stamp_ns : waiting_)
    to_command_.push_back(1e-6 * static_cast<double>(now_ns - stamp_ns));
  waiting_.clear();
  if (fault_ns_ != 0 && speed_ == 0) {
    std::printf("rested %.4f\n", 1e-9 * static_cast<double>(now_ns - fault_ns_));
    std::fflush(stdout);
    fault_ns_ = 0;
  }
}

void FastArm::take_wrench(const Bytes& message) {
  const std::int64_t now_ns = system_ns();
  Decoder decoder(message);
  const std::int64_t stamp_ns = read_header(decoder.cdr);
  const std::lock_guard lock(mutex_);
  to_wrench_.push_back(1e-6 * static_cast<double>(now_ns - stamp_ns));
  waiting_.push_back(stamp_ns);
}

void FastArm::publish_state(std::int64_t now_ns) {
  std::vector<double> q = q_;
  if (fault_ == "silent") return;
  if (fault_ == "nan") q[1] = std::numeric_limits<double>::quiet_NaN();
  if (fault_ == "short") q.pop_back();
  if (fault_ == "late") now_ns -= kSecond / 2;
  dds_.write("rt/" + options_.states, encoded(now_ns, [&](Cdr& cdr) {
               cdr << options_.names << q << dq_ << std::vector<double>();
             }));
}

void FastArm::publish_wrench(std::int64_t now_ns) {
  // Whole us, as palpate's times are; and no two readings are equal.
  now_ns -= now_ns % 1000;
  const double noise = 1e-3 * std::sin(1e-6 * static_cast<double>(now_ns % kSecond));
  dds_.write("rt/" + options_.wrench, encoded(now_ns, [&](Cdr& cdr) {
               for (int i = 0; i < 6; ++i) cdr << noise;
             }));
}

void FastArm::run() {
  auto next = std::chrono::steady_clock::now();
  while (!ended_) {
    {
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < q_.size(); ++i) q_[i] += 1e-3 * dq_[i];
      publish_state(system_ns());
    }
    if (!options_.wrench.empty()) publish_wrench(system_ns());
    next += std::chrono::milliseconds(1);
    std::this_thread::sleep_until(next);
  }
}

void FastArm::set_fault(const std::string& fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
  fault_ns_ = fault.empty() ? 0 : system_ns();
}

std::string FastArm::state() const {
  const std::lock_guard lock(mutex_);
  std::ostringstream text;
  text << commands_ << ' ' << speed_;
  for (const double q : q_) text << ' ' << q;
  return text.str();
}

std::string FastArm::latency() {
  const std::lock_guard lock(mutex_);
  return quantiles(to_wrench_) + " " + quantiles(to_command_);
}

}  // namespace fast_peer
