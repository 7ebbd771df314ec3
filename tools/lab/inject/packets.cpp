#include "tools/lab/inject/packets.hpp"

#include <algorithm>
#include <array>
#include <palpate/biotac_t.hpp>
#include <palpate/channels.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/sim_tick_t.hpp>
#include <palpate/touch_request_t.hpp>
#include <palpate/world_state_t.hpp>
#include <stdexcept>

namespace palpate::inject {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::array<const char*, kKinds> kNames = {
    "random_bytes",     "bad_magic",     "truncated",           "long_channel",   "unended_channel",
    "wrong_type",       "wrong_size",    "negative_count",      "huge_count",     "oversize",
    "fragment_wrapped", "fragment_huge", "fragment_duplicated", "fragment_mixed", "random_payload"};

constexpr int kLargestDatagram = 65507;
constexpr int kFragmentSize = 1400;
constexpr int kCountsOfShape = 48;  // offset of shape_t's node_count in its encoding

template <class Message>
Target target(const char* channel) {
  return {channel, Message::getHash(), Message().getEncodedSize()};
}

void append_word(Bytes& bytes, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(word >> shift));
}

void put_word(Bytes& bytes, std::size_t at, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.at(at++) = static_cast<std::uint8_t>(word >> shift);
}

void append_fingerprint(Bytes& bytes, std::int64_t fingerprint) {
  append_word(bytes, static_cast<std::uint32_t>(static_cast<std::uint64_t>(fingerprint) >> 32));
  append_word(bytes, static_cast<std::uint32_t>(fingerprint));
}

}  // namespace

const char* name(Kind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

Kind kind_from(const std::string& text) {
  const auto found = std::find(kNames.begin(), kNames.end(), text);
  if (found != kNames.end()) return static_cast<Kind>(found - kNames.begin());
  std::string known;
  for (const char* one : kNames) known += std::string(known.empty() ? "" : ", ") + one;
  throw std::invalid_argument("unknown kind \"" + text + "\"; known: " + known);
}

std::vector<Kind> malformed_kinds() {
  std::vector<Kind> kinds;
  for (int i = 0; i < kKinds; ++i)
    if (static_cast<Kind>(i) != Kind::kRandomPayload) kinds.push_back(static_cast<Kind>(i));
  return kinds;
}

std::vector<Target> usual_targets() {
  return {target<ft_wrench_t>(channel::kFtWrench),
          target<imu_t>(channel::kImu),
          target<robot_state_t>(channel::kRobotState),
          target<hand_state_t>(channel::kHandState),
          target<manual_force_t>(channel::kManualForce),
          target<biotac_t>(channel::kBiotac0),
          target<world_state_t>(channel::kWorldState),
          target<component_command_t>(channel::kComponentCommand),
          target<shape_target_t>(channel::kShapeTarget),
          target<touch_request_t>(channel::kTouchRequest),
          target<sim_tick_t>(channel::kSimTick),
          target<shape_t>(channel::kShape)};
}

Bytes short_message(std::uint32_t sequence, const std::string& channel, const Bytes& payload) {
  Bytes bytes{'L', 'C', '0', '2'};
  append_word(bytes, sequence);
  bytes.insert(bytes.end(), channel.begin(), channel.end());
  bytes.push_back(0);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

PacketSource::PacketSource(std::uint64_t seed, std::vector<Kind> kinds, std::vector<Target> targets)
    : random_(seed), kinds_(std::move(kinds)), targets_(std::move(targets)) {
  if (kinds_.empty() || targets_.empty())
    throw std::invalid_argument("packets want at least one kind and one channel");
}

// The bias of the remainder does not matter here; standard distributions differ between libraries.
int PacketSource::draw(int least, int most) {
  return least + static_cast<int>(random_() % static_cast<std::uint64_t>(most - least + 1));
}

std::uint32_t PacketSource::draw_word() { return static_cast<std::uint32_t>(random_()); }

void PacketSource::append_random(Bytes& bytes, int count) {
  while (count > 0) {
    std::uint64_t drawn = random_();
    for (int i = 0; i < 8 && count > 0; ++i, --count, drawn >>= 8)
      bytes.push_back(static_cast<std::uint8_t>(drawn));
  }
}

PacketSource::Bytes PacketSource::good_message(const Target& target) {
  Bytes payload;
  append_fingerprint(payload, target.fingerprint);
  append_random(payload, target.encoded_size - 8);
  return short_message(draw_word(), target.channel, payload);
}

/// A shape_t that announces `count` nodes but holds none.
PacketSource::Bytes PacketSource::arrays(std::int32_t count) {
  Bytes payload;
  append_fingerprint(payload, shape_t::getHash());
  append_random(payload, kCountsOfShape - 8);
  append_word(payload, static_cast<std::uint32_t>(count));
  append_word(payload, 0);  // first_node
  append_word(payload, static_cast<std::uint32_t>(count));
  append_random(payload, draw(0, 200));
  return short_message(draw_word(), channel::kShape, payload);
}

PacketSource::Bytes PacketSource::fragment(std::uint32_t sequence, std::uint32_t size,
                                           std::uint32_t offset, int number, int of, int bytes) {
  Bytes out{'L', 'C', '0', '3'};
  append_word(out, sequence);
  append_word(out, size);
  append_word(out, offset);
  append_word(out, static_cast<std::uint32_t>(number) << 16 | static_cast<std::uint32_t>(of));
  if (number == 0) {
    const std::string& channel = targets_[draw(0, static_cast<int>(targets_.size()) - 1)].channel;
    out.insert(out.end(), channel.begin(), channel.end());
    out.push_back(0);
  }
  append_random(out, bytes);
  return out;
}

void PacketSource::make_fragments(Kind kind) {
  const std::uint32_t sequence = draw_word();
  const std::uint32_t whole = 3 * kFragmentSize;
  switch (kind) {
    case Kind::kFragmentWrapped:
      made_.push_back(fragment(sequence, whole, 0, 0, 3, kFragmentSize));
      made_.push_back(fragment(sequence, whole, 0U - static_cast<std::uint32_t>(draw(1, 1024)), 1,
                               3, kFragmentSize));
      break;
    case Kind::kFragmentHuge:
      made_.push_back(fragment(sequence, 0x80000000U + draw_word() % 0x7fffffffU, 0, 0,
                               draw(1, 65535), kFragmentSize));
      break;
    case Kind::kFragmentDuplicated:
      made_.push_back(fragment(sequence, whole, 0, 0, 3, kFragmentSize));
      made_.push_back(fragment(sequence, whole, kFragmentSize, 1, 3, kFragmentSize));
      made_.push_back(made_.back());
      break;
    default:
      for (const int number : {2, 0, 1})
        for (std::uint32_t message = 0; message < 2; ++message)
          made_.push_back(fragment(sequence + message, whole,
                                   static_cast<std::uint32_t>(number * kFragmentSize), number, 3,
                                   kFragmentSize));
  }
}

void PacketSource::make(Kind kind) {
  Target target = targets_[draw(0, static_cast<int>(targets_.size()) - 1)];
  Bytes bytes;
  switch (kind) {
    case Kind::kRandomBytes:
      append_random(bytes, draw(0, 2000));
      break;
    case Kind::kBadMagic:
      bytes = good_message(target);
      put_word(bytes, 0, draw_word() | 0x80000000U);  // never a letter
      break;
    case Kind::kTruncated:
      bytes = good_message(target);
      bytes.resize(static_cast<std::size_t>(draw(0, static_cast<int>(bytes.size()) - 1)));
      break;
    case Kind::kLongChannel:
      target.channel.resize(static_cast<std::size_t>(draw(64, 2000)), 'A');
      bytes = good_message(target);
      break;
    case Kind::kUnendedChannel:
      target.channel.resize(static_cast<std::size_t>(draw(1, 63)), 'A');
      bytes = short_message(draw_word(), target.channel, {});
      bytes.pop_back();
      break;
    case Kind::kWrongFingerprint:
      target.fingerprint ^= std::int64_t{1} << draw(0, 63);
      bytes = good_message(target);
      break;
    case Kind::kWrongSize:
      target.encoded_size += draw(0, 1) == 0 ? draw(1, 64) : -draw(1, target.encoded_size - 8);
      bytes = good_message(target);
      break;
    case Kind::kNegativeCount:
      bytes = arrays(-draw(1, 1000));
      break;
    case Kind::kHugeCount:
      bytes = arrays(draw(0, 1) == 0 ? 0x40000000 : 0x20000000 + draw(0, 1000));
      break;
    case Kind::kOversize:
      bytes = short_message(draw_word(), target.channel, {});
      append_random(bytes, kLargestDatagram - static_cast<int>(bytes.size()));
      break;
    case Kind::kRandomPayload:
      bytes = good_message(target);
      break;
    default:
      return make_fragments(kind);
  }
  made_.push_back(std::move(bytes));
}

const PacketSource::Bytes& PacketSource::next() {
  if (given_ == made_.size()) {
    made_.clear();
    given_ = 0;
    kind_ = kinds_[static_cast<std::size_t>(draw(0, static_cast<int>(kinds_.size()) - 1))];
    make(kind_);
  }
  return made_[given_++];
}

}  // namespace palpate::inject
