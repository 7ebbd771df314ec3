#pragma once

#include <palpate/health_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>

#include "rt/bus/checked_decode.hpp"

namespace palpate::log {

/// Decodes one complete message from untrusted bytes: of its present type, or of a former type of
/// that name (docs/messages.md), which is converted. Former shapes and meshes contain the corner
/// nodes only: the elements of such a mesh have 4 nodes, whatever its element_kind. False if the
/// message has another type or size.
template <class Message>
bool decode(Message& message, const void* data, int size) {
  return bus::checked_decode(message, data, size);
}
bool decode(health_t& message, const void* data, int size);
bool decode(shape_t& message, const void* data, int size);
bool decode(shape_mesh_t& message, const void* data, int size);

}  // namespace palpate::log
