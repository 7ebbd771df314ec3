#include "tools/record/message_types.hpp"

#include <cstring>

#include "tools/types/decoder.hpp"

namespace palpate::record {
namespace {

template <class Number>
Number big_endian(const void* data) noexcept {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = value << 8 | bytes[i];
  return static_cast<Number>(value);
}

// A jump beyond this is a sender that restarted with the same session (a log played again).
constexpr std::int32_t kLargestGap = 1'000'000;
constexpr std::int32_t kLatest = 1000;  // a message this far behind is a late one

}  // namespace

const MessageType* type_of(const void* data, int size) noexcept {
  if (size < kMessageHeaderSize) return nullptr;
  const auto fingerprint = big_endian<std::int64_t>(data);
  for (const MessageType& type : message_types()) {
    if (type.fingerprint == fingerprint) return &type;
  }
  return nullptr;
}

MessageHeader header_of(const void* data) noexcept {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  return {big_endian<std::int64_t>(bytes + 8), big_endian<std::int32_t>(bytes + 16),
          big_endian<std::int64_t>(bytes + 20)};
}

Recognised recognise(const void* data, int size, const types::TypeSet& foreign) {
  if (const MessageType* own = type_of(data, size)) {
    const bool fits = own->fits(data, size);
    return {&own->name, fits, fits};
  }
  const types::Struct* type = foreign.type_of(data, size);
  if (type == nullptr) return {};
  return {&type->name, types::fits(*type, data, size), false};
}

void SequenceGaps::take(const MessageHeader& header) {
  const auto found = last_.find(header.session);
  if (found == last_.end()) {
    // Above any number of real senders; random sessions must not exhaust memory.
    if (last_.size() < kMostSessions) last_[header.session].seq = header.seq;
    return;
  }
  Sender& sender = found->second;
  // Modulo 2^32, as senders count.
  const auto ahead = static_cast<std::int32_t>(static_cast<std::uint32_t>(header.seq) -
                                               static_cast<std::uint32_t>(sender.seq));
  if (ahead == 0) return;
  if (ahead < 0 && ahead > -kLatest) {
    if (sender.missing > 0) {
      --sender.missing;
      --lost_;
    }
    return;
  }
  if (ahead > 0 && ahead < kLargestGap) {
    lost_ += ahead - 1;
    sender.missing += ahead - 1;
  } else {
    sender.missing = 0;
  }
  sender.seq = header.seq;
}

}  // namespace palpate::record
