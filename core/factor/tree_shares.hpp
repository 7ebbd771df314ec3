#pragma once

#include <vector>

#include "core/factor/supernodes.hpp"

namespace palpate::factor {

/// Elimination tree partitioned among the members of a team. Subtrees are independent in a solve,
/// but contribute to the supernodes above them.
struct TreeShares {
  /// Supernodes of a subtree: a contiguous range, because they are in postorder.
  struct Range {
    int begin, end;
  };
  /// Supernode above all subtrees.
  struct Top {
    int node;
    bool is_shared;  // large enough to be shared by all members
  };
  std::vector<std::vector<Range>> members;  // ascending
  std::vector<Top> top;                     // ascending
};

/// Partition that minimises the estimated completion time, from the costs of the panels.
/// Deterministic. A single member receives the whole tree.
TreeShares share_tree(const Supernodes& nodes, int members);

}  // namespace palpate::factor
