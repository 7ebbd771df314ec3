#pragma once

#include <CLI/CLI.hpp>
#include <ostream>

#include "tools/fit/simulators/soft_object.hpp"

namespace palpate::fit {

// Files of other simulators. Each begins with a comment that states source, law and what differs
// from palpate's model. Lengths in m, in the base W.

/// Model of MuJoCo 4 (MJCF): `flex` of linear tetrahedra with a body for each node that moves,
/// whose mass is that of its share of the elements. `flexcomp` would give all nodes one mass.
void write_mjcf(const SoftObject& object, std::ostream& out);

/// Model of Drake (SDFormat with Drake's elements), which names `mesh_file`. What is fixed must
/// lie behind planes along the axes of O, since Drake fixes no other nodes. Throws config::Error
/// otherwise, and for an object of several materials.
void write_drake_sdf(const SoftObject& object, const std::string& mesh_file, std::ostream& out);

/// Scene of SOFA from version 24.06 (XML), which names `mesh_file`. Throws config::Error for an
/// object of several materials.
void write_sofa(const SoftObject& object, const std::string& mesh_file, std::ostream& out);

/// The mesh in VTK's legacy format, which Drake and SOFA read.
void write_vtk(const SoftObject& object, std::ostream& out);

/// Adds the command `export`, which writes a configuration's object as these files. `code` becomes
/// its exit code once it has run. It throws config::Error and std::runtime_error.
void add_export_command(CLI::App& app, int& code);

/// Lines on the source of a file, and what it leaves out.
std::vector<std::string> remarks(const SoftObject& object);

/// Three numbers with the fewest digits that read as the same.
std::string words(const Eigen::Vector3d& v);

}  // namespace palpate::fit
