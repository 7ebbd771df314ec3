#pragma once

#include <vector>

#include "core/factor/block_matrix.hpp"

namespace palpate::factor {

/// Elimination orders by CHOLMOD: approximate minimum degree (AMD), nested dissection by METIS, and
/// its own nested dissection with constrained minimum degree (NESDIS). Throws std::bad_alloc, and
/// std::runtime_error if CHOLMOD cannot be started.
std::vector<std::vector<int>> cholmod_orders(const Graph& graph);

}  // namespace palpate::factor
