#pragma once

#include <filesystem>

#include "tools/export/csv_export.hpp"
#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// Writes the shapes of a log for ParaView, `rate` per second (0: all): FOLDER/estimate.pvd,
/// truth.pvd if the log holds the truth, and forces.pvd if it holds contacts or grasps, each with
/// its series of .vtu files. SI units, in O. Time is in s since the start of the logs.
///
/// - estimate, at nodes: displacement, deviation from the truth, standard_deviation, force
///   (external force on the node); in elements: strain (Green-Lagrange: xx yy zz xy xz yz),
///   equivalent_strain, stress (Cauchy, same order), von_mises_stress.
/// - truth: the same without deviations; stress and force if its stiffness is given.
/// - forces: points of application of contacts, grasps and unknown contacts: force, torque, kind (0
///   contact, 1 grasp as estimated, 2 unknown contact, 3 true grasp, 4 contact with
///   an obstacle as predicted), number.
///
/// Fields that the log does not provide are omitted in every file of a series. Throws
/// std::runtime_error.
std::vector<Written> export_vtu(ShapeFollower& follower, double rate,
                                const std::filesystem::path& folder);

/// Nodes of a box-shaped 27-node hexahedron, given by their rest positions, in VTK's order.
Eigen::VectorXi vtk_order(const Eigen::Matrix3Xd& nodes);

}  // namespace palpate::exporting
