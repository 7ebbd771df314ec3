#include "tests/bench/core/elasticity/floor_report.hpp"

#include <nlohmann/json.hpp>

#include "core/elasticity/inertia.hpp"
#include "tests/bench/core/elasticity/correction_cost.hpp"
#include "tests/bench/core/elasticity/memory_stream.hpp"
#include "tools/common/table.hpp"

namespace palpate::bench {
namespace {

using common::number;
using Eigen::Matrix3Xd;

/// Minimum number of additions and multiplications (and divisions and roots) of an element, counted
/// from the formulas of point_kernel.hpp and element_block.hpp, with one Newton step for the
/// rotation of each point.
double element_flops(mesh::ElementOrder order) {
  constexpr double kRotation = 24;   // matrix from a quaternion
  constexpr double kStretch = 57;    // R^T F, its symmetric and antisymmetric parts
  constexpr double kTurn = 48 + 28;  // (tr(S) I - S)^-1 g, and the rotated quaternion
  constexpr double kStress = 74;     // energy, stress, its product with R
  constexpr double kPoint = 2 * kRotation + 2 * kStretch + kTurn + kStress;
  constexpr double kGradient = 45, kTraction = 54;  // F from three vectors, forces from P
  if (order == mesh::ElementOrder::kLinear) return 9 + kGradient + kPoint + kTraction + 12;
  constexpr double kCorners = 36 + 24;  // contribution of each point to the four corners' vectors
  constexpr double kOnce = 27 + 60 + 36 + 90 + 30;  // differences, shared sums, nodal forces
  return kOnce + 4 * (kCorners + kGradient + kPoint + kTraction);
}

/// The bar bent and rotated, as smooth as a solution.
Matrix3Xd bent(const Matrix3Xd& rest) {
  Matrix3Xd x = rest;
  for (int i = 0; i < x.cols(); ++i) x(2, i) += 0.5 * x(0, i) * x(0, i);
  return math::exp_rotation(Eigen::Vector3d(0.1, 0.2, -0.3)) * x;
}

StepPart element_pass(const LatencyRow& row, const elasticity::Body& body, double evaluations) {
  StepPart part{"element pass", evaluations};
  const elasticity::Precision precision = row.options.solver.precision;
  part.work = body.mesh.element_count() * element_flops(body.mesh.order);
  part.is_flops = true;
  part.floor = part.work / (precision == elasticity::Precision::kSingle ? peak_flops_single()
                                                                        : peak_flops_double());
  part.measured = time_element_pass(body, bent(body.mesh.nodes), precision);
  return part;
}

StepPart mass_pass(const elasticity::Body& body, double evaluations) {
  StepPart part{"mass pass", evaluations};
  const elasticity::ElementSet elements(body);
  elasticity::Inertia inertia(elements, elasticity::mesh_numbering(body.mesh));
  elasticity::NodalField x = elasticity::NodalField::Zero(4, body.mesh.node_count());
  x.topRows<3>() = bent(body.mesh.nodes);
  elasticity::NodalField y = 1.1 * x, forces = x;
  part.measured = median_time([&] { inertia.add(x, y, 1, forces); });
  // One mass and one column index for each pair of nodes; three fields of four numbers per node.
  const factor::BlockPattern pattern(body.mesh.elements, body.mesh.node_count(), {});
  const double pairs = 2.0 * static_cast<double>(pattern.row().size()) - pattern.size();
  part.work = pairs * (sizeof(double) + sizeof(int)) + 3 * 4 * sizeof(double) * x.cols();
  part.floor = part.work / read_bandwidth(static_cast<std::size_t>(part.work));
  return part;
}

StepPart solve(const LatencyRow& row, const elasticity::Body& body, double corrections) {
  StepPart part{"solve", corrections};
  const SolveCost cost = time_solve(body, Volumetric::kAtPoints, row.options.solver.panels);
  part.work = 2.0 * static_cast<double>(cost.bytes);  // forward and backward
  part.floor = part.work / read_bandwidth(cost.bytes);
  part.measured = cost.seconds;
  return part;
}

}  // namespace

double FloorReport::floor() const {
  double sum = 0;
  for (const StepPart& part : parts) sum += part.times * part.floor;
  return sum;
}

FloorReport find_floor(const LatencyRow& row) {
  const Scenario scenario(row.options.mesh, row.options.motion, row.options.young_modulus);
  const double corrections = row.result.iterations.mean();
  const double evaluations = corrections + (row.options.solver.confirm ? 1 : 0);
  FloorReport report;
  report.mesh = row.options.mesh.text();
  report.step = row.result.step.cpu.quantile(0.5);
  report.parts.push_back(element_pass(row, scenario.body(), evaluations));
  if (row.options.mechanics == Mechanics::kDynamic) {
    report.parts.push_back(mass_pass(scenario.body(), evaluations));
  }
  report.parts.push_back(solve(row, scenario.body(), corrections));
  StepPart rest{"the rest", 1};
  rest.measured = report.step;
  for (const StepPart& part : report.parts) rest.measured -= part.times * part.measured;
  report.parts.push_back(rest);
  return report;
}

void print_floors(const std::vector<FloorReport>& reports, std::ostream& out) {
  const auto us = [](double seconds) { return number(1e6 * seconds, 1); };
  common::Table table(
      {"gap to the floor", "times", "work", "at", "floor us", "us", "x floor", "% of step"});
  for (const FloorReport& report : reports) {
    table.section(report.mesh);
    for (const StepPart& part : report.parts) {
      const bool known = part.floor > 0;
      table.add(
          {part.name, number(part.times, 2),
           known ? number((part.is_flops ? 1e-6 : 1e-3) * part.work, part.is_flops ? 3 : 0) +
                       (part.is_flops ? " Mflop" : " kB")
                 : "",
           known ? number(1e-9 * part.work / part.floor, 0) + (part.is_flops ? " Gflop/s" : " GB/s")
                 : "",
           known ? us(part.times * part.floor) : "", us(part.times * part.measured),
           known ? number(part.measured / part.floor, 1) : "",
           number(100 * part.times * part.measured / report.step, 0)});
    }
    table.add({"step", "", "", "", us(report.floor()), us(report.step),
               number(report.step / report.floor(), 1), "100"});
  }
  table.print(out);
}

nlohmann::json to_json(const FloorReport& report) {
  nlohmann::json parts = nlohmann::json::array();
  for (const StepPart& part : report.parts) {
    parts.push_back({{"name", part.name},
                     {"times_per_step", part.times},
                     {part.is_flops ? "flops" : "bytes", part.work},
                     {"floor_s", part.floor},
                     {"measured_s", part.measured}});
  }
  return {{"step_s", report.step}, {"floor_s", report.floor()}, {"parts", parts}};
}

}  // namespace palpate::bench
