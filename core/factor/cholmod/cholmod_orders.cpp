#include "core/factor/cholmod/cholmod_orders.hpp"

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <stdexcept>

#include "core/factor/cholmod/one_thread.hpp"

namespace palpate::factor {
namespace {

struct Analysis {
  cholmod_common common{};
  cholmod_sparse* pattern = nullptr;
  cholmod_factor* factor = nullptr;

  Analysis() {
    if (cholmod_start(&common) == 0) throw std::runtime_error("CHOLMOD cannot be started");
    common.print = 0;
    common.nmethods = 1;
    common.supernodal = CHOLMOD_SIMPLICIAL;
  }
  Analysis(const Analysis&) = delete;
  Analysis& operator=(const Analysis&) = delete;
  ~Analysis() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&pattern, &common);
    cholmod_finish(&common);
  }

  /// Upper triangle.
  void set_pattern(const Graph& graph) {
    const auto n = static_cast<std::size_t>(graph.size());
    const std::size_t entries = graph.neighbours.size() / 2 + n;
    pattern = cholmod_allocate_sparse(n, n, entries, 0, 1, 1, CHOLMOD_PATTERN, &common);
    if (pattern == nullptr) throw std::bad_alloc();
    auto* start = static_cast<int*>(pattern->p);
    auto* row = static_cast<int*>(pattern->i);
    int count = 0;
    for (int k = 0; k < graph.size(); ++k) {
      start[k] = count;
      for (int s = graph.start[k]; s < graph.start[k + 1]; ++s) {
        if (graph.neighbours[s] < k) row[count++] = graph.neighbours[s];
      }
      row[count++] = k;
    }
    start[graph.size()] = count;
  }
};

}  // namespace

std::vector<std::vector<int>> cholmod_orders(const Graph& graph) {
  const OneThread one_thread;
  Analysis analysis;
  analysis.set_pattern(graph);
  std::vector<std::vector<int>> orders;
  for (const int ordering : {CHOLMOD_AMD, CHOLMOD_METIS, CHOLMOD_NESDIS}) {
    analysis.common.method[0].ordering = ordering;
    analysis.common.status = CHOLMOD_OK;
    analysis.factor = cholmod_analyze(analysis.pattern, &analysis.common);
    if (analysis.factor != nullptr && analysis.common.status == CHOLMOD_OK) {
      const auto* order = static_cast<const int*>(analysis.factor->Perm);
      orders.emplace_back(order, order + graph.size());
    }
    cholmod_free_factor(&analysis.factor, &analysis.common);
  }
  return orders;
}

}  // namespace palpate::factor
