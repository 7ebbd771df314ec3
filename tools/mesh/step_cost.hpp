#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh_tool {

/// Measured cost of a step of the daemon's mechanics on this mesh and machine.
struct StepCost {
  bool measured = false;
  std::string why_not;
  int nodes = 0;       // of the order
  double median = 0;   // s, per step on one core
  double slowest = 0;  // s, 99th percentile
  double factor = 0;   // s, of a new factorisation, which runs in the background of the loop
};

/// Clamps the nodes at the lower end of the longest axis, constrains those at the upper end (a
/// tenth of the length each) and moves them for some hundred steps of 1 ms, as a hand would.
StepCost measure_step_cost(const mesh::TetrahedralMesh& mesh, mesh::ElementOrder order);

std::string text(const StepCost& cost);
nlohmann::json to_json(const StepCost& cost);

}  // namespace palpate::mesh_tool
