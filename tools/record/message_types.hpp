#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/types/type_set.hpp"

namespace palpate::record {

/// One of palpate's types, all of which begin with utime, seq and session.
struct MessageType {
  std::string name;
  std::int64_t fingerprint = 0;
  int smallest = 0;  // encoded bytes with its fingerprint; the complete size if it is fixed
  /// Whether `size` bytes, the fingerprint among them, can be decoded as this type; safe for any.
  bool (*fits)(const void* data, int size) = nullptr;
};

/// All of lcmtypes/, in alphabetical order.
const std::vector<MessageType>& message_types();

/// Type of an encoded message; nullptr if it is unknown.
const MessageType* type_of(const void* data, int size) noexcept;

/// Header of every type.
struct MessageHeader {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int64_t session = 0;
};
inline constexpr int kMessageHeaderSize = 28;  // with the fingerprint in front

/// Header of a message of a known type; `data` holds at least kMessageHeaderSize bytes.
MessageHeader header_of(const void* data) noexcept;

/// What is known of an encoded message.
struct Recognised {
  const std::string* type = nullptr;  // its name; nullptr: unknown
  bool fits = false;                  // it can be decoded as this type
  bool has_header = false;            // and begins with a MessageHeader: it is one of palpate's
};

/// Looks first among palpate's types, then among `foreign`. Safe for any bytes.
Recognised recognise(const void* data, int size, const types::TypeSet& foreign);

/// Counts the lost messages of one channel, by the gaps in each sender's sequence. A message that
/// arrives late is subtracted again.
class SequenceGaps {
 public:
  void take(const MessageHeader& header);

  std::int64_t lost() const noexcept { return lost_; }
  /// Number of senders' starts, at most kMostSessions.
  int sessions() const noexcept { return static_cast<int>(last_.size()); }

 private:
  static constexpr std::size_t kMostSessions = 64;
  struct Sender {
    std::int32_t seq = 0;
    std::int64_t missing = 0;  // of this sender, not come yet
  };
  std::map<std::int64_t, Sender> last_;
  std::int64_t lost_ = 0;
};

}  // namespace palpate::record
