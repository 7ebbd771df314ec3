#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/box.hpp"

namespace palpate::registry {

// Parts of the object that its configuration names: by a box in O at rest, or by a group of the
// mesh file.

constexpr double kSmallShare = 0.02;  // of the body's extent, between a bound and a row of nodes

using MeshGroups = std::map<std::string, mesh::MeshGroup>;

/// The group that the text `key` of `node` names. Throws config::Error, with the names of all
/// groups, if there is none.
const mesh::MeshGroup& read_group(const config::Node& node, const config::Key& key,
                                  const MeshGroups& groups);

/// Whether section `object` has the part `name`: "fixed", "grasp" or "second_grasp".
bool has_part(const config::Node& object, const std::string& name);

/// The boxes of these parts, as far as they are given by boxes.
std::vector<Box> boxes_of_parts(const config::Node& object);

/// Nodes of a part, from the key `<name>_box` or `<name>_group`; empty if neither is there.
/// `remarks` receives a line for each bound of a box that lies between rows of nodes; may be null.
/// Throws config::Error if both keys are given, or if the part holds no node.
std::vector<int> read_part(const config::Node& object, const std::string& name,
                           const mesh::MeshWithGroups& source, const mesh::ElementMesh& mesh,
                           std::vector<std::string>* remarks);

/// Nodes of a grasp, from the key `<name>_nodes`, which a hand that closes again has found; empty
/// if the key is not there. Throws config::Error.
std::vector<int> read_numbered_nodes(const config::Node& object, const std::string& name,
                                     const mesh::ElementMesh& mesh);

/// Throws config::Error if part `name` holds nodes of part `other`; both lists ascend.
void check_overlap(const config::Node& object, const std::string& name,
                   const std::vector<int>& nodes, const std::string& other,
                   const std::vector<int>& others);

/// Sets the materials of the elements from the list `regions` of section `material`: parts of
/// another stiffness, of which the last one counts where they overlap. Throws config::Error.
void read_stiffness_regions(const config::Node& material, const mesh::MeshWithGroups& source,
                            elasticity::Body& body);

}  // namespace palpate::registry
