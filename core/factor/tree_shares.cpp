#include "core/factor/tree_shares.hpp"

#include <algorithm>
#include <numeric>

namespace palpate::factor {
namespace {

using Range = TreeShares::Range;

/// Cost of synchronising all members for a panel, twice per solve, in the unit of panel costs: two
/// or three microseconds.
constexpr double kTogether = 25000;
/// Maximum number of subtrees evaluated per member.
constexpr int kSubtreesPerMember = 12;

struct Tree {
  explicit Tree(const Supernodes& nodes)
      : cost(nodes.count()), first(nodes.count()), children(nodes.count() + 1) {
    std::iota(first.begin(), first.end(), 0);
    for (int s = 0; s < nodes.count(); ++s) {
      const int parent = nodes.parent(s);
      cost[s] += nodes.cost(s);
      children[parent].push_back(s);
      if (parent == nodes.count()) continue;
      cost[parent] += cost[s];
      first[parent] = std::min(first[parent], first[s]);
    }
  }

  std::vector<double> cost;                // cost of the subtree
  std::vector<int> first;                  // first supernode of the subtree
  std::vector<std::vector<int>> children;  // last entry: the roots
};

/// Assigns the largest subtree first, each to the member with the least work. Returns the work of
/// the busiest member.
double deal(const Tree& tree, std::vector<int> roots, std::vector<std::vector<Range>>& members) {
  std::sort(roots.begin(), roots.end(), [&tree](int a, int b) {
    return tree.cost[a] != tree.cost[b] ? tree.cost[a] > tree.cost[b] : a < b;
  });
  std::vector<double> load(members.size());
  for (int s : roots) {
    const auto least = std::min_element(load.begin(), load.end()) - load.begin();
    load[least] += tree.cost[s];
    members[least].push_back({tree.first[s], s + 1});
  }
  return *std::max_element(load.begin(), load.end());
}

double cost_together(double cost, int members) { return cost / members + kTogether; }

}  // namespace

TreeShares share_tree(const Supernodes& nodes, int members) {
  TreeShares best;
  if (members == 1) {
    best.members = {{{0, nodes.count()}}};
    return best;
  }
  const Tree tree(nodes);
  std::vector<int> roots = tree.children.back();
  std::vector<TreeShares::Top> top;
  double top_cost = 0, least = -1;
  // Split the most expensive subtree at its root until this no longer helps.
  for (;;) {
    std::vector<std::vector<Range>> dealt(members);
    const double time = deal(tree, roots, dealt) + top_cost;
    if (least < 0 || time < least) {
      least = time;
      best = {std::move(dealt), top};
    }
    const auto largest = std::max_element(
        roots.begin(), roots.end(), [&tree](int a, int b) { return tree.cost[a] < tree.cost[b]; });
    if (largest == roots.end() || static_cast<int>(roots.size()) > kSubtreesPerMember * members) {
      break;
    }
    const int s = *largest;
    roots.erase(largest);
    const double alone = nodes.cost(s), together = cost_together(alone, members);
    top.push_back({s, together < alone});
    top_cost += std::min(alone, together);
    roots.insert(roots.end(), tree.children[s].begin(), tree.children[s].end());
  }
  for (std::vector<Range>& ranges : best.members) {
    std::sort(ranges.begin(), ranges.end(),
              [](const Range& a, const Range& b) { return a.begin < b.begin; });
  }
  std::sort(best.top.begin(), best.top.end(),
            [](const TreeShares::Top& a, const TreeShares::Top& b) { return a.node < b.node; });
  return best;
}

}  // namespace palpate::factor
