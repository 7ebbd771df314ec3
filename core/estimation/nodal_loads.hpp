#pragma once

#include "core/contact/force_transformer.hpp"

namespace palpate::estimation {

inline bool is_wrist(sensing::Source source) noexcept {
  return source == sensing::Source::kWrist0 || source == sensing::Source::kWrist1;
}

/// True where the node exists and the force is finite.
inline bool is_valid(const contact::NodalLoad& load, int node_count) noexcept {
  return load.node >= 0 && load.node < node_count && load.force.allFinite();
}

}  // namespace palpate::estimation
