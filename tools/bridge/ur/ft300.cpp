#include "ft300.hpp"

#include <charconv>

namespace palpate::ur_bridge {
namespace {

constexpr std::size_t kMostText = 256;               // characters of one reading
constexpr std::int64_t kAgain300 = 1'000'000'000;    // ns until the next attempt to connect
constexpr std::int64_t kSilence300 = 2'000'000'000;  // ns without a character that end a connection

}  // namespace

bool WrenchText::parse(math::Wrench& wrench) const {
  const char* at = text_.data();
  const char* const end = at + text_.size();
  std::array<double, 6> numbers{};
  const auto skip_spaces = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n')) ++at;
  };
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    skip_spaces();
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc()) return false;
    at = next;
    skip_spaces();
    if (i + 1 < numbers.size() && (at == end || *at++ != ',')) return false;
  }
  wrench = {Eigen::Vector3d(numbers.data()), Eigen::Vector3d(numbers.data() + 3)};
  return at == end && wrench.force.allFinite() && wrench.torque.allFinite();
}

bool WrenchText::take(char character, math::Wrench& wrench) {
  if (character == '(') {
    malformed_ += is_inside_ ? 1 : 0;
    is_inside_ = true;
    text_.clear();
    return false;
  }
  if (!is_inside_) return false;
  if (character == ')') {
    is_inside_ = false;
    if (parse(wrench)) return true;
    ++malformed_;
    return false;
  }
  if (text_.size() < kMostText) {
    text_ += character;
    return false;
  }
  is_inside_ = false;
  ++malformed_;
  return false;
}

Ft300::Ft300(std::unique_ptr<bridge::Stream> stream, double polarity,
             std::function<std::int64_t()> now_ns)
    : stream_(std::move(stream)), polarity_(polarity), now_ns_(std::move(now_ns)) {}

void Ft300::connect(std::int64_t now_ns) {
  if (now_ns < again_ns_) return;
  again_ns_ = now_ns + kAgain300;
  heard_ns_ = now_ns;
  text_.restart();
  stream_->open();
}

bool Ft300::take(math::Wrench& wrench_S) {
  while (true) {
    while (begin_ < end_) {
      math::Wrench wrench;
      if (!text_.take(static_cast<char>(received_[static_cast<std::size_t>(begin_++)]), wrench))
        continue;
      ++readings_;
      wrench_S = {polarity_ * wrench.force, polarity_ * wrench.torque};
      return true;
    }
    const std::int64_t now_ns = now_ns_();
    if (stream_->state() == bridge::Stream::State::kClosed) connect(now_ns);
    begin_ = 0;
    end_ = stream_->read(received_.data(), static_cast<int>(received_.size()));
    if (end_ > 0)
      heard_ns_ = now_ns;
    else if (now_ns - heard_ns_ > kSilence300)
      stream_->close();
    if (end_ == 0) return false;
  }
}

}  // namespace palpate::ur_bridge
