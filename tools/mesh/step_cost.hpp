#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh_tool {

/// What a step of the daemon's mechanics costs on this mesh and machine, measured.
struct StepCost {
  bool measured = false;
  std::string why_not;
  int nodes = 0;       // of the order
  double median = 0;   // s, of one step on one core
  double slowest = 0;  // s, 99th percentile
  double factor = 0;   // s, of a new factorisation, which runs beside the loop
};

/// Clamps the nodes at the lower end of the longest axis, holds those at the upper end (a tenth of
/// the length each) and moves them for some hundred steps of 1 ms, as a hand would.
StepCost measure_step_cost(const mesh::TetrahedralMesh& mesh, mesh::ElementOrder order);

std::string text(const StepCost& cost);
nlohmann::json to_json(const StepCost& cost);

}  // namespace palpate::mesh_tool
