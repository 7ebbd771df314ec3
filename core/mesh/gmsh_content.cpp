#include "core/mesh/gmsh_content.hpp"

#include <algorithm>
#include <set>

namespace palpate::mesh {
namespace {

// Gmsh's element type numbers.
constexpr long kTenNodes = 11;
bool is_triangle(long type) { return type == 2 || type == 9; }  // 3 or 6 nodes
/// Number of corners of a solid cell that is not a tetrahedron; 0 otherwise.
int other_corners(long type) {
  switch (type) {
    case 5:
    case 12:
    case 17:
      return 8;
    case 6:
    case 13:
    case 18:
      return 6;
    case 7:
    case 14:
    case 19:
      return 5;
    default:
      return 0;
  }
}

const char* name_of(int corners) {
  return corners == 8 ? "hexahedron" : corners == 6 ? "prism" : "pyramid";
}

}  // namespace

int gmsh_node_count(long type) {
  constexpr int kCounts[] = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                             8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  return type >= 1 && type <= 31 ? kCounts[type] : 0;
}

bool is_gmsh_tetrahedron(long type) { return type == 4 || type == kTenNodes; }

std::string GmshContent::add_node(long number, const Eigen::Vector3d& p) {
  if (!p.allFinite() && on_fault_ == OnFault::kThrow) return "a coordinate is not finite";
  if (!nodes_.emplace(number, p).second)
    return "node " + std::to_string(number) + " is given twice";
  return "";
}

std::string GmshContent::add_element(long number, long type, const std::vector<long>& nodes,
                                     const std::vector<long>& groups) {
  const int corners = other_corners(type);
  const bool is_solid = is_gmsh_tetrahedron(type) || corners > 0;
  if (on_fault_ == OnFault::kThrow && corners > 0) {
    return "element " + std::to_string(number) + " is a " + name_of(corners) +
           "; only tetrahedra can be read (palpate-mesh repair splits others)";
  }
  if (type >= 29 && type <= 31) return "tetrahedra must have 4 or 10 nodes";
  if (on_fault_ == OnFault::kThrow && (is_triangle(type) || is_solid)) {
    for (const long node : nodes) {
      if (nodes_.count(node) == 0) return "there is no node " + std::to_string(node);
    }
  }
  if (corners > 0) {
    others_.push_back({number, {nodes.begin(), nodes.begin() + corners}});
    return "";
  }
  if (!is_solid) flat_nodes_.insert(flat_nodes_.end(), nodes.begin(), nodes.end());
  if (!is_triangle(type) && !is_solid) return "";
  Element element{number, {}, groups, {}};
  std::copy_n(nodes.begin(), is_triangle(type) ? 3 : 4, element.nodes.begin());
  if (type == kTenNodes) element.middles.assign(nodes.begin() + 4, nodes.begin() + 10);
  (is_triangle(type) ? triangles_ : tetrahedra_).push_back(std::move(element));
  return "";
}

/// Nodes of the resulting mesh, in ascending order of their numbers.
std::map<long, int> GmshContent::numbered_nodes() const {
  std::map<long, int> index;
  for (const Element& element : tetrahedra_) {
    for (const long node : element.nodes) index[node] = 0;
  }
  for (const Other& other : others_) {
    for (const long node : other.nodes) index[node] = 0;
  }
  if (on_fault_ == OnFault::kKeep) {
    std::set<long> known(flat_nodes_.begin(), flat_nodes_.end());
    for (const Element& element : tetrahedra_) {
      known.insert(element.middles.begin(), element.middles.end());
    }
    for (const auto& [number, p] : nodes_) {
      if (known.count(number) == 0) index[number] = 0;
    }
    for (auto node = index.begin(); node != index.end();) {
      node = nodes_.count(node->first) == 0 ? index.erase(node) : std::next(node);
    }
  }
  int next = 0;
  for (auto& [number, node] : index) node = next++;
  return index;
}

void GmshContent::add_groups(const std::map<long, int>& index, MeshWithGroups& result) const {
  struct Members {
    std::vector<Eigen::Vector3i> triangles;
    std::vector<int> tetrahedra;
    std::set<int> nodes;
  };
  std::map<std::string, Members> groups;
  const auto name = [this](int dimension, long number) {
    const auto found = names.find({dimension, number});
    return found == names.end() ? std::to_string(number) : found->second;
  };
  for (int t = 0; t < result.mesh.tetrahedron_count(); ++t) {
    for (const long number : tetrahedra_[t].groups) {
      Members& group = groups[name(3, number)];
      group.tetrahedra.push_back(t);
      for (const int n : result.mesh.tetrahedra.col(t)) {
        if (n >= 0) group.nodes.insert(n);
      }
    }
  }
  for (const Element& element : triangles_) {
    Eigen::Vector3i corners;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const auto found = index.find(element.nodes[i]);
      inside = inside && found != index.end();
      corners[i] = inside ? found->second : -1;
    }
    if (!inside) continue;  // a surface that does not bound a tetrahedron
    for (const long number : element.groups) {
      Members& group = groups[name(2, number)];
      group.triangles.push_back(corners);
      group.nodes.insert(corners.begin(), corners.end());
    }
  }
  for (const auto& [group_name, members] : groups) {
    MeshGroup& group = result.groups[group_name];
    group.tetrahedra = members.tetrahedra;
    group.nodes.assign(members.nodes.begin(), members.nodes.end());
    group.triangles.resize(3, static_cast<int>(members.triangles.size()));
    for (int t = 0; t < group.triangles.cols(); ++t) group.triangles.col(t) = members.triangles[t];
  }
}

MeshWithGroups GmshContent::assemble() const {
  const std::map<long, int> index = numbered_nodes();
  const auto index_of = [&index](long number) {
    const auto found = index.find(number);
    return found == index.end() ? -1 : found->second;
  };
  MeshWithGroups result;
  result.mesh.nodes.resize(3, static_cast<int>(index.size()));
  for (const auto& [number, node] : index) {
    result.mesh.nodes.col(node) = nodes_.at(number);
    result.node_numbers.push_back(number);
  }
  result.mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra_.size()));
  for (int t = 0; t < result.mesh.tetrahedron_count(); ++t) {
    const Element& element = tetrahedra_[t];
    result.tetrahedron_numbers.push_back(element.number);
    for (int i = 0; i < 4; ++i) result.mesh.tetrahedra(i, t) = index_of(element.nodes[i]);
    for (std::size_t i = 0; i < element.middles.size(); ++i) {
      const int a = result.mesh.tetrahedra(kGmshEdges[i][0], t),
                b = result.mesh.tetrahedra(kGmshEdges[i][1], t);
      const auto found = nodes_.find(element.middles[i]);
      if (a >= 0 && b >= 0 && found != nodes_.end())
        result.middles[std::minmax(a, b)] = found->second;
    }
  }
  for (const Other& other : others_) {
    OtherCell& cell = result.others.emplace_back();
    cell.number = other.number;
    cell.corner_count = static_cast<int>(other.nodes.size());
    std::transform(other.nodes.begin(), other.nodes.end(), cell.corners.begin(), index_of);
  }
  add_groups(index, result);
  return result;
}

}  // namespace palpate::mesh
