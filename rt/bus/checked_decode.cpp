#include "rt/bus/checked_decode.hpp"

#include <cstring>
#include <palpate/contacts_v1_t.hpp>
#include <palpate/health_v1_t.hpp>
#include <type_traits>
#include <utility>

namespace palpate::bus {
namespace {

template <class Former, class Message>
void copy_header(const Former& former, Message& message) {
  message = {};
  message.utime = former.utime;
  message.seq = former.seq;
  message.session = former.session;
}

template <class Array>
void copy_array(const Array& from, Array& to) {
  std::memcpy(&to, &from, sizeof(Array));
}

void convert(contacts_v1_t&& former, contacts_t& message) {
  copy_header(former, message);
  message.count = former.count;
  copy_array(former.source, message.source);
  copy_array(former.location, message.location);
  copy_array(former.wrench, message.wrench);
  copy_array(former.deviation, message.deviation);
}

/// The fields only had other names.
void convert(health_v1_t&& former, health_t& message) {
  static_assert(sizeof(health_v1_t) == sizeof(health_t) &&
                std::is_trivially_copyable_v<health_v1_t> &&
                std::is_trivially_copyable_v<health_t>);
  std::memcpy(&message, &former, sizeof(message));
}

void convert(shape_v1_t&& former, shape_t& message) {
  copy_header(former, message);
  message.mesh_hash = former.mesh_hash;
  message.status = former.status;
  message.age_us = former.age_us;
  message.chunks = 1;
  message.node_count = former.node_count;
  message.xyz_count = former.xyz_count;
  message.xyz = std::move(former.xyz);
  message.deviation_count = former.deviation_count;
  message.deviation = std::move(former.deviation);
}

void convert(shape_mesh_v1_t&& former, shape_mesh_t& message) {
  copy_header(former, message);
  message.mesh_hash = former.mesh_hash;
  message.element_kind = former.element_kind;
  message.chunk = former.chunk;
  message.chunks = former.chunks;
  message.node_count = former.corner_count;
  message.first_node = former.first_node;
  message.rest_xyz_count = former.rest_xyz_count;
  message.rest_xyz = std::move(former.rest_xyz);
  message.element_size = former.element_size;
  message.element_index_count = former.element_index_count;
  message.elements = std::move(former.elements);
  message.triangle_index_count = former.triangle_index_count;
  message.triangles = std::move(former.triangles);
  message.constrained_count = former.constrained_count;
  message.constrained = std::move(former.constrained);
}

template <class Former, class Message>
bool decode_either(Message& message, const void* data, int size) {
  if (checked_decode(message, data, size)) return true;
  Former former;
  if (!checked_decode(former, data, size)) return false;
  convert(std::move(former), message);
  return true;
}

}  // namespace

bool decode(contacts_t& message, const void* data, int size) {
  return decode_either<contacts_v1_t>(message, data, size);
}
bool decode(health_t& message, const void* data, int size) {
  return decode_either<health_v1_t>(message, data, size);
}
bool decode(shape_t& message, const void* data, int size) {
  return decode_either<shape_v1_t>(message, data, size);
}
bool decode(shape_mesh_t& message, const void* data, int size) {
  return decode_either<shape_mesh_v1_t>(message, data, size);
}

}  // namespace palpate::bus
