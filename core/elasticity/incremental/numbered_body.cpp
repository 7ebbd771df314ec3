#include "core/elasticity/incremental/numbered_body.hpp"

#include <utility>

namespace palpate::elasticity {
namespace {

Body validated(Body body) {
  body.check();
  return body;
}

std::vector<int> elimination_numbering(const factor::BlockPattern& pattern) {
  std::vector<int> numbering(pattern.node_count());
  int next = pattern.size();
  for (int node = 0; node < pattern.node_count(); ++node) {
    numbering[node] = pattern.unknown(node) >= 0 ? pattern.unknown(node) : next++;
  }
  return numbering;
}

}  // namespace

NumberedBody::NumberedBody(Body whole, factor::Orders more)
    : body(validated(std::move(whole))),
      elements(body),
      pattern(body.mesh.elements, body.mesh.node_count(), body.fixed_nodes, patches(body), more),
      supernodes(pattern),
      numbering(elimination_numbering(pattern)),
      rest(NodalField::Zero(4, body.mesh.node_count())) {
  for (int node = 0; node < node_count(); ++node) {
    rest.col(numbering[node]).head<3>() = body.mesh.nodes.col(node);
  }
}

}  // namespace palpate::elasticity
