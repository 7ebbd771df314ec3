#include "tools/lab/faults/stream.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <palpate/channels.hpp>

namespace palpate::faults {
namespace {

constexpr int kUtime = 8, kSeq = 16, kSession = 20;

/// LCM encodes numbers in network byte order.
template <class T>
T get(const bus::Published& message, int offset) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::copy_n(message.data.begin() + offset, sizeof(T), bytes.rbegin());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

template <class T>
void put(bus::Published& message, int offset, T value) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  std::copy(bytes.rbegin(), bytes.rend(), message.data.begin() + offset);
}

void add_run(std::vector<int>& offsets, int first, int count) {
  for (int i = 0; i < count; ++i) offsets.push_back(first + 8 * i);
}

}  // namespace

Header header_of(const bus::Published& message) {
  return {get<std::int64_t>(message, kUtime), get<std::int32_t>(message, kSeq),
          get<std::int64_t>(message, kSession)};
}

void put_header(bus::Published& message, const Header& header) {
  put(message, kUtime, header.utime);
  put(message, kSeq, header.seq);
  put(message, kSession, header.session);
}

bool is_sensor(const std::string& channel) {
  return channel == channel::kFtWrench || channel == channel::kImu ||
         channel == channel::kRobotState || channel == channel::kHandState;
}

std::vector<int> number_offsets(const bus::Published& message) {
  std::vector<int> offsets;
  if (message.channel == channel::kFtWrench || message.channel == channel::kImu) {
    add_run(offsets, kHeaderSize, 6);
  } else if (message.channel == channel::kRobotState) {
    const int joints = get<std::int32_t>(message, kHeaderSize);
    const int q = kHeaderSize + 4, dq = q + 16 * 8, pose = dq + 2 * 16 * 8;
    add_run(offsets, q, joints);
    add_run(offsets, dq, joints);
    add_run(offsets, pose, 3 + 4 + 6);
  } else if (message.channel == channel::kHandState) {
    const int fingers = get<std::int32_t>(message, kHeaderSize + 4);
    const int position = kHeaderSize + 8, quaternion = position + 5 * 3 * 8;
    add_run(offsets, position, 3 * fingers);
    add_run(offsets, quaternion, 4 * fingers);
  }
  return offsets;
}

double number_at(const bus::Published& message, int offset) { return get<double>(message, offset); }

void put_number(bus::Published& message, int offset, double value) { put(message, offset, value); }

}  // namespace palpate::faults
