#pragma once

#include <vector>

#include "core/factor/supernodes.hpp"

namespace palpate::factor {

/// An elimination tree parted among the members of a team. Subtrees do not touch each other in a
/// solve, but add to what is above them.
struct TreeShares {
  /// The supernodes of a subtree: it is a run of them, for they stand in postorder.
  struct Range {
    int begin, end;
  };
  /// A supernode above all subtrees.
  struct Top {
    int node;
    bool is_shared;  // large enough for all members to work on at once
  };
  std::vector<std::vector<Range>> members;  // rising
  std::vector<Top> top;                     // rising
};

/// Such that the members are done soonest, as far as the costs of panels tell. The same for the
/// same arguments. One member has the whole tree.
TreeShares share_tree(const Supernodes& nodes, int members);

}  // namespace palpate::factor
