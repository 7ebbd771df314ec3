#pragma once

#include "tools/lab/cases/case_run.hpp"

namespace palpate::cases {

/// Comparison of a shape, and of its support reactions, with the reference of its case.
struct CaseFigures {
  double largest_reference = 0;  // m, displacement of a reference probe
  double probe_rms = 0;          // m, length of the error
  double probe_max = 0;
  double outside = 0;                   // m, of the probe farthest outside the mesh
  std::optional<Eigen::Vector3d> mean;  // m, mean displacement of the monitored face
  std::optional<double> twist_deg;      // of that face, if the case monitors it
  std::optional<math::Wrench> grasp;    // of the hand on the body, at the displaced centre
  std::optional<math::Wrench> fixed;    // of the clamp on the body, about the origin of O

  double rms_share() const { return probe_rms / largest_reference; }
  double max_share() const { return probe_max / largest_reference; }
};

/// `reactions`: N, on each supported node; if absent, the wrenches are omitted.
CaseFigures score_shape(const CaseFile& c, const CaseProblem& problem,
                        const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd* reactions);

/// Figures compared with a row of baseline_on_delivered_meshes: those that are available.
struct BaselineDifference {
  double rms_share = 0;  // ours minus theirs
  double max_share = 0;
  // Length of the difference relative to that of the reference.
  std::optional<double> mean, twist, force, moment;

  double largest_share() const;     // of the error norms, absolute
  double largest_relative() const;  // of the others
};

/// The stored row "P1_NAME" or "P2_NAME"; nullptr if there is none.
const nlohmann::json* baseline_row(const CaseFile& c, mesh::ElementOrder order,
                                   const std::string& mesh);
BaselineDifference compare(const CaseFigures& figures, const nlohmann::json& row);

/// One case on one mesh with one element.
struct CaseScore {
  std::string name;
  std::string mesh;
  mesh::ElementOrder order = mesh::ElementOrder::kQuadratic;
  int nodes = 0;
  int elements = 0;
  elasticity::StaticSolution equilibrium;
  CaseFigures figures;  // of the static solution
  std::optional<IncrementalRun> incremental;
  std::optional<DynamicRun> dynamic;
  std::optional<CaseFigures> dynamic_figures;
  const nlohmann::json* baseline = nullptr;  // in the case

  bool converged() const;
};

struct ScoreCaseOptions {
  int ticks = 500;  // of the load ramp in the incremental model; 0: not run
  std::optional<DynamicOptions> dynamic;
};

CaseScore score_case(const CaseFile& c, const std::string& mesh_name,
                     const mesh::MeshWithGroups& mesh, mesh::ElementOrder order,
                     const ScoreCaseOptions& options);

}  // namespace palpate::cases
