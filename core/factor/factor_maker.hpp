#pragma once

#include <memory>

#include "core/factor/supernodal_factor.hpp"

namespace palpate::factor {

/// Creates a factor for these supernodes, which must outlive it.
using FactorMaker = std::unique_ptr<SupernodalFactor> (*)(const Supernodes& supernodes);

/// palpate's own L D L^T; the alternative is core/factor/cholmod/cholmod_factor.hpp.
inline std::unique_ptr<SupernodalFactor> make_own_factor(const Supernodes& supernodes) {
  return std::make_unique<SupernodalFactor>(supernodes);
}

}  // namespace palpate::factor
