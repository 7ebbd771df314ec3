#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/bench/core/elasticity/candidate_elements.hpp"
#include "tests/bench/core/elasticity/round_bodies.hpp"
#include "tools/lab/cases/case_mesh.hpp"

namespace palpate::bench {

/// One body on one mesh with one kind of element: its error and the cost of a correction.
struct ElementRow {
  std::string body, element, mesh;
  bool is_given = false;  // the mesh was supplied with the case
  int nodes = 0;
  double rms_share = 0;  // of the largest reference displacement
  long entries = 0;      // scalars of the factor's panels
  double pass = 0;       // s, of one pass over the elements
  double solve = 0;      // s, of one solve
  double seconds() const { return pass + solve; }
};

/// The elements of the study, as named in the tables.
inline constexpr const char* kLinear = "linear";
inline constexpr const char* kAveragedLinear = "linear averaged";
inline constexpr const char* kQuadratic = "quadratic";
inline constexpr const char* kInflatedLinear = "linear inflated";
inline constexpr const char* kInflatedQuadratic = "quadratic inflated";
inline constexpr const char* kCurvedQuadratic = "quadratic curved";

/// A reference case on a mesh with its groups; empty if statics does not converge.
std::optional<ElementRow> measure_case(const cases::CaseFile& c, const std::string& mesh_name,
                                       const mesh::MeshWithGroups& mesh,
                                       const std::string& element);

/// Displacements of the probes of a round body (3 x probes), if its statics converges.
std::optional<Eigen::Matrix3Xd> solve_round(const RoundBody& round);

/// A round body compared with displacements of a reference.
std::optional<ElementRow> measure_round(const RoundBody& round, const std::string& name,
                                        const std::string& mesh_name, const std::string& element,
                                        const Eigen::Matrix3Xd& reference);

/// Those on given meshes and those on the Pareto front of node count and error for the same
/// element.
std::vector<ElementRow> unbeaten(const std::vector<ElementRow>& rows);

/// Body by body.
void print_rows(const std::vector<ElementRow>& rows, std::ostream& out);

/// For each body and element the shortest time in which some mesh achieves an error.
void print_least_times(const std::vector<ElementRow>& rows, std::ostream& out);

}  // namespace palpate::bench
