#include "fci_client.hpp"

#include <algorithm>
#include <cstring>

namespace palpate::franka_bridge {
namespace {

constexpr std::int64_t kAnswer =
    2'000'000'000;                            // ns for an answer, and of silence that is a failure
constexpr std::int64_t kAgain = 500'000'000;  // ns until the next attempt
constexpr std::uint32_t kMostAnswer = 4096;   // bytes; longer ones are an error of the protocol
constexpr int kBufferSize = 4 * static_cast<int>(kMostAnswer);
constexpr std::size_t kMostRemarks = 16;
constexpr std::uint8_t kOtherVersion = 1;  // status of an answer to kConnect

}  // namespace

FciClient::FciClient(std::unique_ptr<bridge::Stream> stream, std::unique_ptr<Datagrams> datagrams)
    : stream_(std::move(stream)), datagrams_(std::move(datagrams)), received_(kBufferSize) {}

void FciClient::remark(const std::string& text) {
  // An attempt that fails as the one before says nothing new.
  if (text == last_remark_ || remarks_.size() >= kMostRemarks) return;
  last_remark_ = text;
  remarks_.push_back(text);
}

std::string FciClient::next_remark() {
  if (remarks_.empty()) return "";
  std::string text = std::move(remarks_.front());
  remarks_.pop_front();
  return text;
}

void FciClient::fail(const std::string& why) {
  stream_->close();
  phase_ = Phase::kWaiting;
  deadline_ns_ = now_ns_ + kAgain;
  end_ = 0;
  answers_.clear();
  remark("FCI, " + stream_->name() + ": " + why);
}

void FciClient::send(const std::vector<std::uint8_t>& request) {
  ++number_;
  if (!stream_->write(request.data(), static_cast<int>(request.size())))
    fail("the connection is lost");
}

std::uint32_t FciClient::request(Request kind) {
  const std::uint32_t number = number_;
  if (is_running())
    send(kind == Request::kMove ? move_request(number_) : recovery_request(number_));
  return number;
}

void FciClient::handle(const Header& header, const std::uint8_t* payload, int size) {
  const auto kind = static_cast<Request>(header.request);
  if (phase_ == Phase::kVersion) {
    if (kind != Request::kConnect || size < 3) return fail("its answer to connect is malformed");
    std::uint16_t version = 0;
    std::memcpy(&version, payload + 1, 2);
    if (payload[0] == kOtherVersion || version != kFciVersion)
      return fail("the arm has version " + std::to_string(version) +
                  " of the FCI; allowed: 10 (robot system 5.9 or newer)");
    if (payload[0] != 0) return fail("it refuses the connection");
    phase_ = Phase::kRunning;
    deadline_ns_ = now_ns_ + kAnswer;
    has_state_ = false;
    return remark("FCI, " + stream_->name() + ": connected");
  }
  if (size < 1) return fail("an answer without a status");
  answers_.push_back({header.number, kind, payload[0]});
}

void FciClient::poll(std::int64_t now_ns) {
  now_ns_ = now_ns;
  if (phase_ == Phase::kWaiting) {
    if (now_ns < deadline_ns_) return;
    stream_->open();
    phase_ = Phase::kConnecting;
    deadline_ns_ = now_ns + kAnswer;
  }
  if (stream_->state() == bridge::Stream::State::kClosed)
    return fail(phase_ == Phase::kConnecting
                    ? "no connection (is the FCI activated, and no other program connected?)"
                    : "the connection is lost");
  if (phase_ == Phase::kConnecting && stream_->state() == bridge::Stream::State::kOpen) {
    // What is left of an earlier connection.
    while (datagrams_->receive(datagram_.data(), kStateSize) >= 0) {
    }
    phase_ = Phase::kVersion;
    deadline_ns_ = now_ns + kAnswer;
    send(connect_request(number_, datagrams_->port()));
  }
  if (phase_ != Phase::kWaiting && now_ns > deadline_ns_)
    return fail(phase_ == Phase::kConnecting ? "no connection"
                : phase_ == Phase::kVersion  ? "no answer"
                                             : "no states");
  while (phase_ != Phase::kWaiting) {
    const int count = stream_->read(received_.data() + end_, kBufferSize - end_);
    end_ += count;
    while (phase_ != Phase::kWaiting && end_ >= kHeaderSize) {
      const Header header = read_header(received_.data());
      if (header.size < kHeaderSize || header.size > kMostAnswer)
        return fail("an answer of " + std::to_string(header.size) + " bytes");
      const int size = static_cast<int>(header.size);
      if (end_ < size) break;
      handle(header, received_.data() + kHeaderSize, size - kHeaderSize);
      if (phase_ == Phase::kWaiting) break;
      std::copy(received_.begin() + size, received_.begin() + end_, received_.begin());
      end_ -= size;
    }
    if (count == 0) return;
  }
}

std::optional<FciClient::Answer> FciClient::take_answer() {
  if (answers_.empty()) return std::nullopt;
  const Answer answer = answers_.front();
  answers_.pop_front();
  return answer;
}

const RobotState* FciClient::take() {
  while (is_running()) {
    const int size = datagrams_->receive(datagram_.data(), kStateSize);
    if (size < 0) return nullptr;
    if (size != kStateSize) {
      if (counts_.malformed++ == 0)
        remark("FCI, " + stream_->name() + ": a state of " + std::to_string(size) +
               " bytes; allowed: " + std::to_string(kStateSize));
      continue;
    }
    std::uint64_t id = 0;
    std::memcpy(&id, datagram_.data(), 8);
    if (has_state_ && id <= state_.id) {
      ++counts_.overtaken;
      continue;
    }
    if (has_state_) counts_.lost += static_cast<std::int64_t>(id - state_.id - 1);
    has_state_ = true;
    read_state(datagram_.data(), state_);
    deadline_ns_ = now_ns_ + kAnswer;
    return &state_;
  }
  return nullptr;
}

void FciClient::command(const Seven& dq, bool is_last) {
  if (!is_running() || !has_state_) return;
  std::array<std::uint8_t, kCommandSize> data;
  write_command(state_.id, dq, is_last, data.data());
  datagrams_->send(data.data(), kCommandSize);
}

}  // namespace palpate::franka_bridge
