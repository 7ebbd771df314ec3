#pragma once

#include <vector>

#include "core/elasticity/supernodes.hpp"

namespace palpate::elasticity {

/// An elimination tree parted among the members of a team. Subtrees do not touch each other in a
/// solve, but add to what is above them.
struct TreeShares {
  /// The supernodes of a subtree: it is a run of them, for they stand in postorder.
  struct Range {
    int begin, end;
  };
  std::vector<std::vector<Range>> members;  // rising
  std::vector<int> top;                     // supernodes above all subtrees, rising
};

/// Subtrees of about the same cost in all for each member, and as little above them as that allows.
/// The same for the same arguments. One member has the whole tree.
TreeShares share_tree(const Supernodes& nodes, int members);

}  // namespace palpate::elasticity
