#pragma once

#include "core/elasticity/static_solver.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/lab/cases/case_face.hpp"
#include "tools/lab/cases/case_file.hpp"

namespace palpate::cases {

/// A case on one mesh with one kind of element, ready to be solved.
struct CaseProblem {
  elasticity::Body body;
  Eigen::Matrix3Xd loads;  // N, beside the weight
  elasticity::HeldPoses held;
  Eigen::Matrix3Xi monitored;  // triangles of the face whose motion is reported; may be none

  /// Pose of the hand a share (0 to 1) of the way through its motion; nothing without a grasp.
  std::optional<math::Pose> hand(double share) const;
};

/// Throws config::Error where the mesh lacks a group or the case makes no valid body.
CaseProblem make_problem(const CaseFile& c, const mesh::MeshWithGroups& mesh,
                         mesh::ElementOrder order);

}  // namespace palpate::cases
