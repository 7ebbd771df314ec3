#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/unit/lcmtypes/all_types.hpp"

namespace palpate {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename Message>
Bytes encode(const Message& message) {
  Bytes bytes(message.getEncodedSize());
  RC_ASSERT(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
            static_cast<int>(bytes.size()));
  return bytes;
}

template <typename Message>
int decode(const Bytes& bytes, Message& message) {
  return message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

Bytes random_bytes(std::size_t size) {
  return *rc::gen::container<Bytes>(size, rc::gen::arbitrary<std::uint8_t>());
}

/// A message with random memory: every field holds any value, including NaN and infinity.
template <typename Message>
Message random_message() {
  Message message;
  const Bytes bytes = random_bytes(sizeof(Message));
  std::memcpy(&message, bytes.data(), sizeof(Message));
  return message;
}

template <typename Vector>
void fill(Vector& values, int count) {
  values.resize(count);
  const Bytes bytes = random_bytes(values.size() * sizeof(values[0]));
  if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
}

int random_count() { return *rc::gen::inRange(0, 40); }

void fill(picture_t& m) {
  m.picture = *rc::gen::arbitrary<std::int32_t>();
  m.chunk = *rc::gen::arbitrary<std::int16_t>();
  fill(m.data, m.size = random_count());
}

template <class Shape>
void fill_shape(Shape& m) {
  m.mesh_hash = *rc::gen::arbitrary<std::int64_t>();
  m.node_count = random_count();
  fill(m.xyz, m.xyz_count = 3 * m.node_count);
  fill(m.deviation, m.deviation_count = m.node_count);
}

void fill(shape_t& m) { fill_shape(m); }
void fill(shape_v1_t& m) { fill_shape(m); }

template <class Mesh>
void fill_mesh(Mesh& m) {
  m.mesh_hash = *rc::gen::arbitrary<std::int64_t>();
  fill(m.rest_xyz, m.rest_xyz_count = random_count());
  fill(m.elements, m.element_index_count = random_count());
  fill(m.triangles, m.triangle_index_count = random_count());
  fill(m.constrained, m.constrained_count = random_count());
}

void fill(shape_mesh_t& m) { fill_mesh(m); }
void fill(shape_mesh_v1_t& m) { fill_mesh(m); }

RC_GTEST_PROP(LcmTypes, DecodeAfterEncodeIsIdentity, ()) {
  for_each_fixed_size_type([](auto type) {
    using Message = decltype(type);
    const Message sent = random_message<Message>();
    // The receiver's memory is initialised with the complement, so a byte that is neither equal nor
    // complementary was decoded wrongly, and one that is still complementary was not decoded.
    Bytes memory(sizeof(Message));
    std::memcpy(memory.data(), &sent, sizeof(Message));
    for (std::uint8_t& byte : memory) byte = static_cast<std::uint8_t>(~byte);
    Message received;
    std::memcpy(&received, memory.data(), sizeof(Message));
    const Bytes bytes = encode(sent);
    RC_ASSERT(decode(bytes, received) == static_cast<int>(bytes.size()));

    std::size_t equal = 0;
    const auto* a = reinterpret_cast<const std::uint8_t*>(&sent);
    const auto* b = reinterpret_cast<const std::uint8_t*>(&received);
    for (std::size_t i = 0; i < sizeof(Message); ++i) equal += a[i] == b[i];
    RC_ASSERT(equal == bytes.size() - 8);  // all but padding; the fingerprint is not a field
    RC_ASSERT(encode(received) == bytes);
  });
}

RC_GTEST_PROP(LcmTypes, DecodeAfterEncodeIsIdentityForVariableSizes, ()) {
  for_each_variable_size_type([](auto sent) {
    fill(sent);
    sent.utime = *rc::gen::arbitrary<std::int64_t>();
    sent.seq = *rc::gen::arbitrary<std::int32_t>();
    const Bytes bytes = encode(sent);
    decltype(sent) received;
    RC_ASSERT(decode(bytes, received) == static_cast<int>(bytes.size()));
    RC_ASSERT(received.utime == sent.utime);
    RC_ASSERT(received.seq == sent.seq);
    RC_ASSERT(encode(received) == bytes);
  });
}

template <typename Message>
void expect_truncated_is_refused(const Bytes& bytes) {
  const std::size_t size = *rc::gen::inRange<std::size_t>(0, bytes.size());
  Message received;
  RC_ASSERT(decode(Bytes(bytes.begin(), bytes.begin() + size), received) < 0);
}

RC_GTEST_PROP(LcmTypes, TruncatedMessagesNeverDecode, ()) {
  for_each_fixed_size_type([](auto type) {
    using Message = decltype(type);
    expect_truncated_is_refused<Message>(encode(random_message<Message>()));
  });
  for_each_variable_size_type([](auto message) {
    fill(message);
    expect_truncated_is_refused<decltype(message)>(encode(message));
  });
}

RC_GTEST_PROP(LcmTypes, AnotherFingerprintNeverDecodes, ()) {
  for_each_fixed_size_type([](auto type) {
    using Message = decltype(type);
    Bytes bytes = encode(random_message<Message>());
    bytes[*rc::gen::inRange(0, 8)] ^= static_cast<std::uint8_t>(*rc::gen::inRange(1, 256));
    Message received;
    RC_ASSERT(decode(bytes, received) < 0);
  });
}

}  // namespace
}  // namespace palpate
