#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace palpate::inject {

/// Defect of a datagram.
enum class Kind {
  kRandomBytes,         // random bytes of random length
  kBadMagic,            // a valid message except for its first four bytes
  kTruncated,           // truncated anywhere, also within the header
  kLongChannel,         // a name of 64 to 2000 characters
  kUnendedChannel,      // a name without its terminating zero
  kWrongFingerprint,    // of the right size and of another type
  kWrongSize,           // of the right type, shorter or longer
  kNegativeCount,       // an array of a negative number of elements
  kHugeCount,           // an array whose size in bytes overflows to zero in 32 bits
  kOversize,            // the largest possible datagram
  kFragmentWrapped,     // an offset that overflows 32 bits when the fragment's size is added
  kFragmentHuge,        // a message of 2^31 bytes or more, declared
  kFragmentDuplicated,  // one fragment twice, another missing
  kFragmentMixed,       // interleaved fragments of two messages, the last before the first
  kRandomPayload,       // right type and size; every value in it is random
};
inline constexpr int kKinds = 15;

/// Name on the command line.
const char* name(Kind kind) noexcept;
/// Throws std::invalid_argument that lists the names.
Kind kind_from(const std::string& text);
/// All kinds that a receiver must reject: every kind except kRandomPayload, whose messages are well
/// formed.
std::vector<Kind> malformed_kinds();

/// A channel and the message type of it.
struct Target {
  std::string channel;
  std::int64_t fingerprint;
  int encoded_size;
};
/// The inputs of palpated, and SHAPE, whose arrays have variable length.
std::vector<Target> usual_targets();

/// An endless sequence of datagrams, the same for the same seed, kinds and targets.
class PacketSource {
 public:
  /// Throws std::invalid_argument if there are no kinds or no targets.
  PacketSource(std::uint64_t seed, std::vector<Kind> kinds, std::vector<Target> targets);

  /// The next one; valid until the next call.
  const std::vector<std::uint8_t>& next();
  /// Kind of the last one.
  Kind kind() const noexcept { return kind_; }

 private:
  using Bytes = std::vector<std::uint8_t>;
  int draw(int least, int most);
  std::uint32_t draw_word();
  void append_random(Bytes& bytes, int count);
  Bytes good_message(const Target& target);
  Bytes arrays(std::int32_t count);
  Bytes fragment(std::uint32_t sequence, std::uint32_t size, std::uint32_t offset, int number,
                 int of, int bytes);
  void make(Kind kind);
  void make_fragments(Kind kind);

  std::mt19937_64 random_;
  std::vector<Kind> kinds_;
  std::vector<Target> targets_;
  std::vector<Bytes> made_;
  std::size_t given_ = 0;
  Kind kind_ = Kind::kRandomBytes;
};

/// A short message of one channel: LCM's header, the name and the payload.
std::vector<std::uint8_t> short_message(std::uint32_t sequence, const std::string& channel,
                                        const std::vector<std::uint8_t>& payload);

}  // namespace palpate::inject
