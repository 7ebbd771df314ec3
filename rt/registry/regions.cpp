#include "rt/registry/regions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "core/mesh/surface.hpp"

namespace palpate::registry {
namespace {

constexpr const char* kParts[] = {"fixed", "grasp", "second_grasp"};

Box read_box(const config::Node& object, const std::string& key) {
  const char* nodes_are =
      key == "fixed_box" ? "Box of the nodes that never move" : "Box of the nodes that are held";
  return object.child({key, "", nodes_are}).read(box_options("in O at rest"));
}

/// Names of the groups for which `is_usable` holds.
template <class IsUsable>
std::string names_of(const MeshGroups& groups, const IsUsable& is_usable) {
  std::string names;
  for (const auto& [name, group] : groups)
    if (is_usable(group)) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "none, the mesh has no such groups" : names;
}

bool has_tetrahedra(const mesh::MeshGroup& group) { return !group.tetrahedra.empty(); }

/// Nodes of a group in the mesh of elements: its corners, and the nodes between two of them on its
/// edges.
std::vector<int> nodes_of(const mesh::MeshGroup& group, const mesh::TetrahedralMesh& corners,
                          const mesh::ElementMesh& mesh) {
  std::vector<int> nodes = group.nodes;
  if (mesh.order == mesh::ElementOrder::kLinear) return nodes;
  std::vector<std::pair<int, int>> edges;
  const auto add = [&edges](int a, int b) { edges.emplace_back(std::min(a, b), std::max(a, b)); };
  for (int t = 0; t < group.triangles.cols(); ++t)
    for (int i = 0; i < 3; ++i) add(group.triangles(i, t), group.triangles((i + 1) % 3, t));
  for (const int t : group.tetrahedra)
    for (const auto& edge : mesh::kTetrahedronEdges)
      add(corners.tetrahedra(edge[0], t), corners.tetrahedra(edge[1], t));
  std::sort(edges.begin(), edges.end());
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int i = 0; i < 6; ++i) {
      const int a = mesh.elements(mesh::kTetrahedronEdges[i][0], e),
                b = mesh.elements(mesh::kTetrahedronEdges[i][1], e);
      const std::pair<int, int> edge{std::min(a, b), std::max(a, b)};
      if (std::binary_search(edges.begin(), edges.end(), edge))
        nodes.push_back(mesh.elements(4 + i, e));
    }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::string in_metres(char axis, double value) {
  char text[48];
  std::snprintf(text, sizeof(text), "%c = %.6g m", axis, value);
  return text;
}

/// A bound of a box that cuts the body between two rows of nodes holds less of it than it says:
/// 6.7 mm of 200 mm cost 0.3 mm of shape error on average and 2 mm at worst.
void remark_on_bounds(const std::string& key, const mesh::ElementMesh& mesh, const Box& box,
                      const std::vector<int>& nodes, std::vector<std::string>& remarks) {
  const Eigen::Matrix3Xd selected = mesh.nodes(Eigen::all, nodes);
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = mesh.nodes.row(axis).maxCoeff() - mesh.nodes.row(axis).minCoeff();
    for (const double side : {-1.0, 1.0}) {  // of the lower and of the upper bound
      const bool at_lower = side < 0;
      const double bound = at_lower ? box.lower[axis] : box.upper[axis];
      const double end = side * (side * selected.row(axis)).maxCoeff();
      if (std::abs(end - bound) <= kSmallShare * extent) continue;
      // The body extends beyond the bound if the box holds more nodes without it.
      Box wider = box;
      (at_lower ? wider.lower : wider.upper)[axis] =
          side * (side * mesh.nodes.row(axis)).maxCoeff();
      double outside = std::numeric_limits<double>::infinity();  // times side
      for (const int node : mesh::nodes_in_box(mesh, wider.lower, wider.upper)) {
        const double at = side * mesh.nodes(axis, node);
        if (at > side * bound) outside = std::min(outside, at);
      }
      if (!std::isfinite(outside)) continue;
      const char name = "xyz"[axis];
      remarks.push_back(
          "object." + key + (at_lower ? ".lower: " : ".upper: ") + in_metres(name, bound) +
          " lies between rows of mesh nodes; the " + (key == "fixed_box" ? "fixed" : "held") +
          " nodes " + (at_lower ? "begin" : "end") + " at " + in_metres(name, end) +
          ", the next nodes outside the box are at " + in_metres(name, side * outside) +
          ": move the bound to a row of nodes or refine the mesh");
    }
  }
}

double read_modulus(const config::Node& region, double young_modulus) {
  if (region.has("factor") == region.has("young_modulus"))
    region.fail("", "exactly one of young_modulus and factor is allowed");
  if (region.has("factor"))
    return young_modulus *
           region.number({"factor", "", "On the modulus of the object"}, {1e-3, 1e3});
  return region.number({"young_modulus", "Pa", "Young's modulus E of the part"}, {1, 1e10});
}

/// Elements whose centroid lies in the box.
std::vector<int> elements_in(const Box& box, const mesh::ElementMesh& mesh) {
  std::vector<int> elements;
  for (int e = 0; e < mesh.element_count(); ++e) {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (int i = 0; i < 4; ++i) centroid += 0.25 * mesh.nodes.col(mesh.elements(i, e));
    if ((centroid.array() >= box.lower.array()).all() &&
        (centroid.array() <= box.upper.array()).all())
      elements.push_back(e);
  }
  return elements;
}

}  // namespace

const mesh::MeshGroup& read_group(const config::Node& node, const config::Key& key,
                                  const MeshGroups& groups) {
  const std::string name = node.text(key);
  const auto found = groups.find(name);
  if (found != groups.end()) return found->second;
  node.fail(key.name, "the mesh has no group '" + name + "'; allowed: " +
                          names_of(groups, [](const mesh::MeshGroup&) { return true; }));
}

bool has_part(const config::Node& object, const std::string& name) {
  return object.has(name + "_box") || object.has(name + "_group");
}

std::vector<int> read_numbered_nodes(const config::Node& object, const std::string& name,
                                     const mesh::ElementMesh& mesh) {
  const std::string key = name + "_nodes";
  std::vector<int> nodes;
  if (!object.has(key)) return nodes;
  const auto count = static_cast<int>(mesh.nodes.cols());
  for (const double node : object.numbers(
           {key, "", "Instead of those of box or group: numbers of the nodes, from 0 on"}, -1,
           {0, 1e6})) {
    if (node >= count)
      object.fail(key, "has node " + std::to_string(static_cast<int>(node)) + "; allowed: 0 to " +
                           std::to_string(count - 1));
    nodes.push_back(static_cast<int>(node));
  }
  return nodes;
}

std::vector<Box> boxes_of_parts(const config::Node& object) {
  std::vector<Box> boxes;
  for (const std::string part : kParts)
    if (object.has(part + "_box")) boxes.push_back(read_box(object, part + "_box"));
  return boxes;
}

std::vector<int> read_part(const config::Node& object, const std::string& name,
                           const mesh::MeshWithGroups& source, const mesh::ElementMesh& mesh,
                           std::vector<std::string>* remarks) {
  const std::string box_key = name + "_box", group_key = name + "_group";
  if (object.has(group_key)) {
    if (object.has(box_key))
      object.fail(group_key, "is given as well as " + box_key + "; allowed: one of them");
    const std::vector<int> nodes = nodes_of(
        read_group(object,
                   {group_key, "",
                    "Instead of the box: named group of the mesh file, of triangles or tetrahedra"},
                   source.groups),
        source.mesh, mesh);
    if (nodes.empty()) object.fail(group_key, "this group of the mesh holds no node");
    return nodes;
  }
  if (!object.has(box_key)) return {};
  const Box box = read_box(object, box_key);
  std::vector<int> nodes = mesh::nodes_in_box(mesh, box.lower, box.upper);
  if (nodes.empty()) object.fail(box_key, "no node of the mesh lies in this box");
  if (remarks != nullptr) remark_on_bounds(box_key, mesh, box, nodes, *remarks);
  return nodes;
}

void check_overlap(const config::Node& object, const std::string& name,
                   const std::vector<int>& nodes, const std::string& other,
                   const std::vector<int>& others) {
  std::vector<int> shared;
  std::set_intersection(nodes.begin(), nodes.end(), others.begin(), others.end(),
                        std::back_inserter(shared));
  if (shared.empty()) return;
  const auto key = [&object](const std::string& part) {
    return part + (object.has(part + "_nodes")   ? "_nodes"
                   : object.has(part + "_group") ? "_group"
                                                 : "_box");
  };
  object.fail(key(name), std::to_string(shared.size()) + " of its " + std::to_string(nodes.size()) +
                             " nodes are held twice: they belong to " + key(other) + " as well");
}

void read_stiffness_regions(const config::Node& material, const mesh::MeshWithGroups& source,
                            elasticity::Body& body) {
  for (const config::Node& region :
       material.list({"regions", "",
                      "Parts of another stiffness; where they overlap the last one "
                      "counts"})) {
    if (region.has("box") == region.has("group"))
      region.fail("", "exactly one of box and group is allowed");
    std::vector<int> elements;
    if (region.has("box"))
      elements = elements_in(region
                                 .child({"box", "",
                                         "Box of the part; an element belongs to it "
                                         "if its centroid does"})
                                 .read(box_options("in O at rest")),
                             body.mesh);
    else
      elements = read_group(region, {"group", "", "Named group of tetrahedra of the mesh file"},
                            source.groups)
                     .tetrahedra;
    if (elements.empty() && region.has("group"))
      region.fail("group", "this group of the mesh holds no tetrahedra; allowed: " +
                               names_of(source.groups, has_tetrahedra));
    if (elements.empty()) region.fail("", "holds no element of the mesh");
    const double young_modulus = read_modulus(region, body.material.young_modulus);
    body.element_materials.resize(static_cast<std::size_t>(body.mesh.element_count()),
                                  body.material);
    for (const int e : elements)
      body.element_materials[static_cast<std::size_t>(e)].young_modulus = young_modulus;
  }
}

}  // namespace palpate::registry
