#include "rtde_client.hpp"

#include <algorithm>

namespace palpate::ur_bridge {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kAnswer = 2000 * kMs;  // ns for an answer, and until silence is a failure
constexpr std::int64_t kAgain = 500 * kMs;    // ns until the next attempt
constexpr std::uint16_t kVersion = 2;         // of the protocol
constexpr std::size_t kMostRemarks = 16;
constexpr int kBuffer = 4 * kMostPackage;

}  // namespace

RtdeClient::RtdeClient(std::unique_ptr<bridge::Stream> stream, Options options)
    : stream_(std::move(stream)),
      options_(std::move(options)),
      output_size_(size_of(options_.outputs)),
      received_(kBuffer) {}

void RtdeClient::remark(const std::string& text) {
  // An attempt that fails as the one before says nothing new.
  if (text == last_remark_ || remarks_.size() >= kMostRemarks) return;
  last_remark_ = text;
  remarks_.push_back(text);
}

std::string RtdeClient::next_remark() {
  if (remarks_.empty()) return "";
  std::string text = std::move(remarks_.front());
  remarks_.pop_front();
  return text;
}

void RtdeClient::fail(const std::string& why) {
  stream_->close();
  phase_ = Phase::kWaiting;
  deadline_ns_ = now_ns_ + kAgain;
  begin_ = end_ = 0;
  remark("RTDE, " + stream_->name() + ": " + why);
}

void RtdeClient::enter(Phase phase) {
  phase_ = phase;
  deadline_ns_ = now_ns_ + kAnswer;
  switch (phase) {
    case Phase::kVersion:
      writer_.begin(PackageType::kProtocolVersion);
      writer_.put(kVersion);
      break;
    case Phase::kController:
      writer_.begin(PackageType::kControllerVersion);
      break;
    case Phase::kOutputs:
      writer_.begin(PackageType::kSetupOutputs);
      writer_.put(options_.rate).put_text(names_of(options_.outputs));
      break;
    case Phase::kInputs:
      writer_.begin(PackageType::kSetupInputs);
      writer_.put_text(names_of(options_.inputs));
      break;
    case Phase::kStart:
      writer_.begin(PackageType::kStart);
      break;
    case Phase::kWaiting:
    case Phase::kConnecting:
    case Phase::kRunning:
      return;
  }
  const std::vector<std::uint8_t>& package = writer_.finish();
  if (!stream_->write(package.data(), static_cast<int>(package.size())))
    fail("the connection is lost");
}

void RtdeClient::handle(PackageType type, PackageReader& reader) {
  if (type == PackageType::kTextMessage) {
    const std::string text = reader.get_text(reader.get<std::uint8_t>());
    const std::string source = reader.get_text(reader.get<std::uint8_t>());
    reader.get<std::uint8_t>();  // level of the warning
    if (!reader.is_complete()) return fail("a text message is malformed");
    return remark("the controller says: " + source + ": " + text);
  }
  const bool is_accepted = type == PackageType::kProtocolVersion || type == PackageType::kStart
                               ? reader.get<std::uint8_t>() == 1
                               : true;
  if (phase_ == Phase::kVersion && type == PackageType::kProtocolVersion) {
    if (!reader.is_complete()) return fail_answer("the protocol's version");
    if (!is_accepted)
      return fail("it refuses version 2 of RTDE's protocol; allowed: a controller that has it");
    return enter(Phase::kController);
  }
  if (phase_ == Phase::kController && type == PackageType::kControllerVersion) {
    const auto major = reader.get<std::uint32_t>(), minor = reader.get<std::uint32_t>();
    reader.get<std::uint32_t>();  // bugfix
    reader.get<std::uint32_t>();  // build
    if (!reader.is_complete()) return fail_answer("its version");
    if (major < static_cast<std::uint32_t>(options_.oldest_major))
      return fail("the controller's software is " + std::to_string(major) + "." +
                  std::to_string(minor) + "; allowed: " + std::to_string(options_.oldest_major) +
                  " or newer for this rate or wrench");
    return enter(Phase::kOutputs);
  }
  if (phase_ == Phase::kOutputs && type == PackageType::kSetupOutputs) {
    output_recipe_ = reader.get<std::uint8_t>();
    const std::string wrong = difference_of(options_.outputs, reader.get_text());
    if (!wrong.empty()) return fail(wrong);
    if (!reader.is_complete() || output_recipe_ == 0) return fail_answer("the outputs");
    return enter(Phase::kInputs);
  }
  if (phase_ == Phase::kInputs && type == PackageType::kSetupInputs) {
    input_recipe_ = reader.get<std::uint8_t>();
    const std::string wrong = difference_of(options_.inputs, reader.get_text());
    if (!wrong.empty()) return fail(wrong);
    if (!reader.is_complete() || input_recipe_ == 0) return fail_answer("the inputs");
    return enter(Phase::kStart);
  }
  if (phase_ == Phase::kStart && type == PackageType::kStart) {
    if (!reader.is_complete()) return fail_answer("start");
    if (!is_accepted) return fail("it refuses to start");
    enter(Phase::kRunning);
    return remark("RTDE, " + stream_->name() + ": connected");
  }
  fail("an unexpected package of type " + std::to_string(static_cast<int>(type)));
}

void RtdeClient::poll(std::int64_t now_ns) {
  now_ns_ = now_ns;
  if (phase_ == Phase::kWaiting) {
    if (now_ns < deadline_ns_) return;
    stream_->open();
    enter(Phase::kConnecting);
  }
  const bridge::Stream::State state = stream_->state();
  if (state == bridge::Stream::State::kClosed)
    return fail(phase_ == Phase::kConnecting ? "no connection" : "the connection is lost");
  if (phase_ == Phase::kConnecting && state == bridge::Stream::State::kOpen) enter(Phase::kVersion);
  if (phase_ != Phase::kWaiting && now_ns > deadline_ns_)
    return fail(phase_ == Phase::kConnecting ? "no connection" : "no answer");
  if (begin_ > 0) {
    std::copy(received_.begin() + begin_, received_.begin() + end_, received_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  // What does not fit stays with the stream until the next cycle.
  while (end_ < kBuffer) {
    const int count = stream_->read(received_.data() + end_, kBuffer - end_);
    if (count == 0) break;
    end_ += count;
  }
}

const std::uint8_t* RtdeClient::take() {
  while (phase_ != Phase::kWaiting && end_ - begin_ >= kHeaderSize) {
    PackageReader reader(received_.data() + begin_, end_ - begin_);
    const int size = reader.get<std::uint16_t>();
    const auto type = static_cast<PackageType>(reader.get<std::uint8_t>());
    if (size < kHeaderSize || size > kMostPackage) {
      fail("a package of " + std::to_string(size) + " bytes");
      break;
    }
    if (end_ - begin_ < size) break;
    const std::uint8_t* fields = received_.data() + begin_ + kHeaderSize;
    begin_ += size;
    if (type != PackageType::kData || phase_ != Phase::kRunning) {
      PackageReader answer(fields, size - kHeaderSize);
      handle(type, answer);
      continue;
    }
    if (size != kHeaderSize + 1 + output_size_ || fields[0] != output_recipe_) {
      fail("data of another recipe or size");
      break;
    }
    deadline_ns_ = now_ns_ + kAnswer;
    return fields + 1;
  }
  return nullptr;
}

PackageWriter& RtdeClient::begin_inputs() {
  writer_.begin(PackageType::kData);
  return writer_.put(input_recipe_);
}

void RtdeClient::send_inputs() {
  const std::vector<std::uint8_t>& package = writer_.finish();
  if (!is_running()) return;
  if (!stream_->write(package.data(), static_cast<int>(package.size())))
    fail("the connection is lost");
}

}  // namespace palpate::ur_bridge
