#include "tools/mesh/regions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <stdexcept>

#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

// What the daemon's configuration holds, by the name of the group.
const char* const kHeld[] = {"clamp", "grasp", "second_grasp"};
const char* const kKeys[] = {"fixed_group", "grasp_group", "second_grasp_group"};

mesh::Face sorted_face(const Eigen::Vector3i& corners) {
  mesh::Face face{corners[0], corners[1], corners[2]};
  std::sort(face.begin(), face.end());
  return face;
}

/// Names stand in quotes, on a line, in Gmsh's files.
void check_name(const std::string& name) {
  constexpr std::size_t kLongest = 127;  // of Gmsh
  const bool is_printable = std::all_of(
      name.begin(), name.end(), [](unsigned char c) { return c >= ' ' && c != '"' && c != 127; });
  if (name.empty() || name.size() > kLongest || !is_printable || name.front() == ' ' ||
      name.back() == ' ')
    throw std::invalid_argument("'" + name +
                                "' is not a name of a group; allowed: 1 to 127 printable "
                                "characters without quotes, no blanks at the ends");
}

std::vector<int> combined(RegionEdit edit, const std::vector<int>& old,
                          const std::vector<int>& members) {
  std::vector<int> result;
  if (edit == RegionEdit::kReplace) return members;
  if (edit == RegionEdit::kAdd)
    std::set_union(old.begin(), old.end(), members.begin(), members.end(),
                   std::back_inserter(result));
  else
    std::set_difference(old.begin(), old.end(), members.begin(), members.end(),
                        std::back_inserter(result));
  return result;
}

std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? "''" : std::string(1, c);
  return text + "'";
}

/// A plain scalar of YAML, or a quoted one.
std::string scalar(const std::string& name) {
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '/';
  });
  return is_plain && std::isalpha(static_cast<unsigned char>(name.front())) ? name : quoted(name);
}

}  // namespace

bool is_held_region(const std::string& name) {
  return std::find(std::begin(kHeld), std::end(kHeld), name) != std::end(kHeld);
}

Regions::Regions(mesh::MeshWithGroups mesh)
    : mesh_(std::move(mesh)),
      surface_(mesh::extract_surface(mesh_.mesh)),
      selection_(mesh_.mesh, surface_.triangles) {
  for (int f = 0; f < surface_.triangles.cols(); ++f)
    face_by_corners_[sorted_face(surface_.triangles.col(f))] = f;
}

const mesh::MeshGroup& Regions::group(const std::string& name) const {
  const auto found = mesh_.groups.find(name);
  if (found != mesh_.groups.end()) return found->second;
  std::string names;
  for (const auto& [other, group] : mesh_.groups) names += (names.empty() ? "" : ", ") + other;
  throw std::invalid_argument("the mesh has no group '" + name + "'; it has " +
                              (names.empty() ? "none" : names));
}

std::vector<int> Regions::members(const std::string& name, RegionKind kind) const {
  const auto found = mesh_.groups.find(name);
  if (found == mesh_.groups.end()) return {};
  if (kind == RegionKind::kElements) return found->second.tetrahedra;
  std::set<int> faces;
  for (int t = 0; t < found->second.triangles.cols(); ++t) {
    const auto face = face_by_corners_.find(sorted_face(found->second.triangles.col(t)));
    if (face != face_by_corners_.end()) faces.insert(face->second);
  }
  return {faces.begin(), faces.end()};
}

std::vector<int> Regions::outer_faces(const std::string& name) const {
  std::set<int> faces;
  for (const int f : members(name, RegionKind::kFaces)) faces.insert(f);
  for (const int t : members(name, RegionKind::kElements)) {
    for (int i = 0; i < 4; ++i) {
      const auto face = face_by_corners_.find(mesh::face_of(mesh_.mesh, t, i));
      if (face != face_by_corners_.end()) faces.insert(face->second);
    }
  }
  return {faces.begin(), faces.end()};
}

RegionKind Regions::kind_of(const std::string& name) const {
  const auto found = mesh_.groups.find(name);
  const bool elements_alone = found != mesh_.groups.end() && !found->second.tetrahedra.empty() &&
                              found->second.triangles.cols() == 0;
  return elements_alone ? RegionKind::kElements : RegionKind::kFaces;
}

void Regions::edit(const std::string& name, RegionKind kind, RegionEdit edit,
                   const std::vector<int>& members) {
  check_name(name);
  if (edit == RegionEdit::kRemove) group(name);
  if (members.empty())
    throw std::invalid_argument(std::string("no ") +
                                (kind == RegionKind::kFaces ? "face of the surface" : "element") +
                                " is selected for the group '" + name + "'");
  const std::vector<int> now = combined(edit, this->members(name, kind), members);
  mesh::MeshGroup& changed = mesh_.groups[name];
  if (kind == RegionKind::kElements) {
    changed.tetrahedra = now;
  } else {
    // Triangles inside the body are kept unless the group is replaced.
    std::vector<Eigen::Vector3i> triangles;
    for (const int f : now) triangles.push_back(surface_.triangles.col(f));
    for (int t = 0; edit != RegionEdit::kReplace && t < changed.triangles.cols(); ++t)
      if (face_by_corners_.count(sorted_face(changed.triangles.col(t))) == 0)
        triangles.push_back(changed.triangles.col(t));
    changed.triangles.resize(3, static_cast<int>(triangles.size()));
    for (std::size_t t = 0; t < triangles.size(); ++t)
      changed.triangles.col(static_cast<int>(t)) = triangles[t];
  }
  std::set<int> nodes(changed.triangles.reshaped().begin(), changed.triangles.reshaped().end());
  for (const int t : changed.tetrahedra)
    for (const int n : mesh_.mesh.tetrahedra.col(t)) nodes.insert(n);
  changed.nodes.assign(nodes.begin(), nodes.end());
  if (nodes.empty()) mesh_.groups.erase(name);
}

void Regions::erase(const std::string& name) {
  group(name);
  mesh_.groups.erase(name);
}

RegionSize Regions::size_of(const std::vector<int>& faces, const std::vector<int>& elements) const {
  RegionSize size;
  size.faces = static_cast<int>(faces.size());
  size.elements = static_cast<int>(elements.size());
  for (const int f : faces) size.area += selection_.area(f);
  for (const int t : elements) size.volume += mesh::volume(mesh_.mesh, t);
  return size;
}

RegionSize Regions::size(const std::string& name) const {
  RegionSize size =
      size_of(members(name, RegionKind::kFaces), members(name, RegionKind::kElements));
  size.nodes = static_cast<int>(group(name).nodes.size());
  return size;
}

RegionSize Regions::whole() const {
  RegionSize size =
      size_of(selection_.all(RegionKind::kFaces), selection_.all(RegionKind::kElements));
  size.nodes = mesh_.mesh.node_count();
  return size;
}

std::string Regions::conflict() const {
  std::string text;
  for (std::size_t a = 0; a < std::size(kHeld); ++a) {
    for (std::size_t b = a + 1; b < std::size(kHeld); ++b) {
      const auto first = mesh_.groups.find(kHeld[a]), second = mesh_.groups.find(kHeld[b]);
      if (first == mesh_.groups.end() || second == mesh_.groups.end()) continue;
      std::vector<int> shared;
      std::set_intersection(first->second.nodes.begin(), first->second.nodes.end(),
                            second->second.nodes.begin(), second->second.nodes.end(),
                            std::back_inserter(shared));
      if (shared.empty()) continue;
      text += (text.empty() ? "" : "; ") + first->first + " and " + second->first + " share " +
              std::to_string(shared.size()) + (shared.size() == 1 ? " node" : " nodes") +
              ", of which palpated holds none twice";
    }
  }
  return text;
}

std::string Regions::configuration(const std::string& file) const {
  std::string text = "object: {mesh: {file: " + scalar(file) + "}";
  for (std::size_t i = 0; i < std::size(kHeld); ++i) {
    if (mesh_.groups.count(kHeld[i]) == 0) continue;
    text += std::string(", ") + kKeys[i] + ": " + kHeld[i];
  }
  std::string stiffness;
  const auto all = static_cast<std::size_t>(mesh_.mesh.tetrahedron_count());
  for (const auto& [name, group] : mesh_.groups)
    if (!group.tetrahedra.empty() && group.tetrahedra.size() < all && !is_held_region(name))
      stiffness += (stiffness.empty() ? "" : ", ") + ("{group: " + scalar(name)) + ", factor: 1}";
  if (!stiffness.empty()) text += ", material: {regions: [" + stiffness + "]}";
  return text + "}";
}

void check_region_file(const std::string& file) {
  if (std::filesystem::path(file).extension() != ".msh")
    throw std::runtime_error(file + ": cannot hold groups of faces; allowed: .msh");
}

void write_regions(const Regions& regions, const std::string& file) {
  check_region_file(file);
  FileFormat format;
  if (!regions.mesh().middles.empty()) format.gmsh.order = mesh::ElementOrder::kQuadratic;
  write_volume(regions.mesh(), file, format);
}

std::map<std::string, Eigen::Vector3f> region_colours(const Regions::Groups& groups) {
  const Eigen::Vector3f held[] = {
      {0.87F, 0.25F, 0.24F}, {0.20F, 0.72F, 0.38F}, {0.22F, 0.50F, 0.90F}};
  const Eigen::Vector3f others[] = {{0.94F, 0.89F, 0.26F}, {0.80F, 0.47F, 0.65F},
                                    {0.90F, 0.62F, 0.00F}, {0.34F, 0.71F, 0.91F},
                                    {0.55F, 0.45F, 0.85F}, {0.55F, 0.40F, 0.20F}};
  std::map<std::string, Eigen::Vector3f> colours;
  std::size_t next = 0;
  for (const auto& [name, group] : groups)
    if (!is_held_region(name)) colours[name] = others[next++ % std::size(others)];
  for (std::size_t i = 0; i < std::size(kHeld); ++i)
    if (groups.count(kHeld[i]) > 0) colours[kHeld[i]] = held[i];
  return colours;
}

}  // namespace palpate::mesh_tool
