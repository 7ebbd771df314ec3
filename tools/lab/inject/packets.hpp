#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace palpate::inject {

/// What is wrong with a datagram.
enum class Kind {
  kRandomBytes,         // any length, anything
  kBadMagic,            // a good message but for its first four bytes
  kTruncated,           // cut anywhere, also within the header
  kLongChannel,         // a name of 64 to 2000 characters
  kUnendedChannel,      // a name without its zero
  kWrongFingerprint,    // of the right size and of another type
  kWrongSize,           // of the right type, shorter or longer
  kNegativeCount,       // an array of a negative number of elements
  kHugeCount,           // an array whose size in bytes wraps to nothing in 32 bits
  kOversize,            // the largest datagram there is
  kFragmentWrapped,     // an offset that wraps in 32 bits when the fragment's size is added
  kFragmentHuge,        // a message of 2^31 bytes or more, declared
  kFragmentDuplicated,  // the same fragment twice, another one never
  kFragmentMixed,       // fragments of two messages among each other, the last before the first
  kRandomPayload,       // right type and size; every number in it is drawn
};
inline constexpr int kKinds = 15;

/// As the command line names it.
const char* name(Kind kind) noexcept;
/// Throws std::invalid_argument that lists the names.
Kind kind_from(const std::string& text);
/// All that no receiver may accept: every kind but kRandomPayload, whose messages are well formed.
std::vector<Kind> malformed_kinds();

/// A channel and the type that belongs on it.
struct Target {
  std::string channel;
  std::int64_t fingerprint;
  int encoded_size;
};
/// What palpated listens to, and SHAPE, whose arrays are of variable length.
std::vector<Target> usual_targets();

/// An endless row of datagrams, the same for the same seed, kinds and targets.
class PacketSource {
 public:
  /// Throws std::invalid_argument where there are no kinds or no targets.
  PacketSource(std::uint64_t seed, std::vector<Kind> kinds, std::vector<Target> targets);

  /// The next one; valid until the next call.
  const std::vector<std::uint8_t>& next();
  /// What the last one is.
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
