#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tests/support/box_mesh.hpp"

namespace palpate::view {

using support::shape_of;

inline std::shared_ptr<const shape_mesh_t> box_mesh(
    const std::array<int, 3>& cells, mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  return std::make_shared<const shape_mesh_t>(support::box_mesh(cells, {0.4, 0.2, 0.1}, order));
}

/// A message as encoded on the bus.
template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

}  // namespace palpate::view
