#include "nearest_nodes.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace example {

palpate::config::OptionTable<NearestNodes::Options> NearestNodes::table() {
  return palpate::config::OptionTable<Options>()
      .integer("nodes", "number of nodes that share a force", {1, kMostNodes}, &Options::nodes)
      .number("reach", "m", "distance from the object beyond which a contact is rejected",
              {1e-4, 10}, &Options::reach);
}

NearestNodes::NearestNodes(const Options& options, const palpate::elasticity::Body& body)
    : options_(options) {
  if (options.nodes > body.mesh.node_count())
    throw std::invalid_argument("the mesh has fewer nodes than `nodes`");
}

void NearestNodes::distribute(const palpate::sensing::Contact& contact,
                              const Eigen::Matrix3Xd& positions,
                              palpate::contact::ContactLoads& out) {
  struct Near {
    double distance;
    int node;
  };
  std::array<Near, kMostNodes + 1> nearest;  // sorted, with room for the one that drops out
  int count = 0;
  for (int i = 0; i < positions.cols(); ++i) {
    const double distance = (positions.col(i) - contact.location).norm();
    if (count == options_.nodes && distance >= nearest[count - 1].distance) continue;
    int at = count;
    for (; at > 0 && nearest[at - 1].distance > distance; --at) nearest[at] = nearest[at - 1];
    nearest[at] = {distance, i};
    count = std::min(count + 1, options_.nodes);
  }
  out.location = contact.location;
  out.accepted = nearest[0].distance <= options_.reach;
  if (!out.accepted) return;
  constexpr double kLeast = 1e-6;  // m, keeps the weight of a touched node finite
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += 1 / (nearest[i].distance + kLeast);
  for (int i = 0; i < count; ++i)
    out.push(nearest[i].node, contact.wrench.force / ((nearest[i].distance + kLeast) * sum));
}

}  // namespace example
