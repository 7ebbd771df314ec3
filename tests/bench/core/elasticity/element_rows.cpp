#include "tests/bench/core/elasticity/element_rows.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/mesh/point_locator.hpp"
#include "tests/bench/core/elasticity/candidate_statics.hpp"
#include "tests/bench/core/elasticity/correction_cost.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/cases/case_score.hpp"

namespace palpate::bench {
namespace {

using common::number;
using Eigen::Matrix3Xd;

void set_cost(const elasticity::Body& body, Volumetric volumetric, const Matrix3Xd& positions,
              ElementRow& row) {
  row.nodes = body.mesh.node_count();
  row.pass = time_element_pass(body, positions);
  const SolveCost cost = time_solve(body, volumetric);
  row.entries = cost.entries;
  row.solve = cost.seconds;
}

template <class Key>
std::vector<std::string> in_order(const std::vector<ElementRow>& rows, const Key& key) {
  std::vector<std::string> names;
  for (const ElementRow& row : rows) {
    if (std::find(names.begin(), names.end(), key(row)) == names.end()) names.push_back(key(row));
  }
  return names;
}

}  // namespace

std::optional<ElementRow> measure_case(const cases::CaseFile& c, const std::string& mesh_name,
                                       const mesh::MeshWithGroups& mesh,
                                       const std::string& element) {
  const cases::CaseProblem problem = cases::make_problem(
      c, mesh,
      element == kQuadratic ? mesh::ElementOrder::kQuadratic : mesh::ElementOrder::kLinear);
  const elasticity::Body& body = problem.body;
  const bool averaged = element == kAveragedLinear;
  Matrix3Xd positions;
  if (averaged) {
    const Matrix3Xd weight = body.gravity_O * elasticity::ElementSet(body).nodal_mass().transpose();
    const CandidateSolution solution =
        solve_candidate(body, Volumetric::kAveraged, problem.loads + weight, problem.held);
    if (!solution.converged) return std::nullopt;
    positions = solution.positions;
  } else {
    const elasticity::StaticSolution solution = cases::solve(problem);
    if (!solution.converged) return std::nullopt;
    positions = solution.positions;
  }
  ElementRow row{c.name, element, mesh_name, c.meshes.count(mesh_name) > 0};
  row.rms_share = cases::score_shape(c, problem, positions, nullptr).rms_share();
  set_cost(body, averaged ? Volumetric::kAveraged : Volumetric::kAtPoints, positions, row);
  return row;
}

namespace {

std::optional<Matrix3Xd> positions_of(const RoundBody& round) {
  const CandidateSolution solution =
      solve_candidate(round.body, Volumetric::kAtPoints, round.loads);
  if (!solution.converged) return std::nullopt;
  return solution.positions;
}

Matrix3Xd probe(const RoundBody& round, const Matrix3Xd& positions) {
  const mesh::PointLocator locator(round.body.mesh);
  const Matrix3Xd u = positions - round.body.mesh.nodes;
  Matrix3Xd at(3, static_cast<int>(round.probes.size()));
  for (int p = 0; p < at.cols(); ++p) at.col(p) = locator.locate(round.probes[p]).interpolate(u);
  return at;
}

}  // namespace

std::optional<Matrix3Xd> solve_round(const RoundBody& round) {
  const auto positions = positions_of(round);
  if (!positions) return std::nullopt;
  return probe(round, *positions);
}

std::optional<ElementRow> measure_round(const RoundBody& round, const std::string& name,
                                        const std::string& mesh_name, const std::string& element,
                                        const Matrix3Xd& reference) {
  const auto positions = positions_of(round);
  if (!positions) return std::nullopt;
  const Matrix3Xd error = probe(round, *positions) - reference;
  ElementRow row{name, element, mesh_name, true};
  row.rms_share =
      std::sqrt(error.colwise().squaredNorm().mean()) / reference.colwise().norm().maxCoeff();
  set_cost(round.body, Volumetric::kAtPoints, *positions, row);
  if (element == kCurvedQuadratic) row.pass = time_curved_pass(round.body, *positions);
  return row;
}

void print_rows(const std::vector<ElementRow>& rows, std::ostream& out) {
  common::Table table(
      {"element", "mesh", "nodes", "nnz of factor", "RMS %", "pass us", "solve us", "us"});
  for (const std::string& body : in_order(rows, [](const ElementRow& r) { return r.body; })) {
    table.section(body);
    for (const ElementRow& row : rows) {
      if (row.body != body) continue;
      table.add({row.element, row.mesh, std::to_string(row.nodes), std::to_string(row.entries),
                 number(100 * row.rms_share, 3), number(1e6 * row.pass, 1),
                 number(1e6 * row.solve, 1), number(1e6 * row.seconds(), 1)});
    }
  }
  table.print(out);
}

std::vector<ElementRow> unbeaten(const std::vector<ElementRow>& rows) {
  std::vector<ElementRow> kept;
  for (const ElementRow& row : rows) {
    const bool beaten = std::any_of(rows.begin(), rows.end(), [&row](const ElementRow& other) {
      return other.body == row.body && other.element == row.element &&
             other.rms_share < row.rms_share && other.nodes <= row.nodes;
    });
    if (row.is_given || !beaten) kept.push_back(row);
  }
  return kept;
}

void print_least_times(const std::vector<ElementRow>& rows, std::ostream& out) {
  const std::vector<double> goals{0.1, 0.05, 0.02, 0.01, 0.005};
  std::vector<std::string> header{"us for an RMS error of at most"};
  for (const double goal : goals) header.push_back(number(100 * goal, 1) + " %");
  common::Table table(header);
  for (const std::string& body : in_order(rows, [](const ElementRow& r) { return r.body; })) {
    table.section(body);
    for (const std::string& element :
         in_order(rows, [](const ElementRow& r) { return r.element; })) {
      std::vector<std::string> cells{element};
      bool is_there = false;
      for (const double goal : goals) {
        const ElementRow* best = nullptr;
        for (const ElementRow& row : rows) {
          if (row.body != body || row.element != element) continue;
          is_there = true;
          if (row.rms_share <= goal && (!best || row.seconds() < best->seconds())) best = &row;
        }
        cells.push_back(best ? number(1e6 * best->seconds(), 1) + " (" +
                                   std::to_string(best->nodes) + ")"
                             : "-");
      }
      if (is_there) table.add(cells);
    }
  }
  table.print(out);
}

}  // namespace palpate::bench
