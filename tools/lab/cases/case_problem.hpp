#pragma once

#include "core/elasticity/static_solver.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/lab/cases/case_face.hpp"
#include "tools/lab/cases/case_file.hpp"

namespace palpate::cases {

/// A case on one mesh with one kind of element, ready to be solved.
struct CaseProblem {
  elasticity::Body body;
  Eigen::Matrix3Xd loads;  // N, in addition to the weight
  elasticity::HeldPoses held;
  Eigen::Matrix3Xi monitored;  // triangles of the face whose motion is reported; may be empty

  /// Pose of the hand at a fraction (0 to 1) of its motion; empty without a grasp.
  std::optional<math::Pose> hand(double share) const;
};

/// Throws config::Error if the mesh lacks a group or the case does not define a valid body.
CaseProblem make_problem(const CaseFile& c, const mesh::MeshWithGroups& mesh,
                         mesh::ElementOrder order);

}  // namespace palpate::cases
