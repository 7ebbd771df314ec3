#include <benchmark/benchmark.h>

#include "tests/bench/core/elasticity/benchmarks.hpp"

int main(int argc, char** argv) {
  namespace bench = palpate::bench;
  std::vector<bench::BarMesh> meshes;
  for (const auto order :
       {palpate::mesh::ElementOrder::kLinear, palpate::mesh::ElementOrder::kQuadratic}) {
    for (const bench::BarMesh& mesh : bench::bar_meshes(order)) {
      if (mesh.node_count() < 5000) meshes.push_back(mesh);
    }
  }
  bench::register_ticks(meshes);
  bench::register_parts(meshes);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
