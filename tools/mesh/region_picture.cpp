#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "core/mesh/connectivity.hpp"
#include "sim/draw/annotate.hpp"
#include "sim/draw/renderer.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/regions.hpp"

namespace palpate::mesh_tool {
namespace {

using Eigen::Vector3d;

constexpr double kViewAngle = 0.5;                          // rad
constexpr int kView = 760, kViewHeight = 700, kStrip = 34;  // px
const draw::Colour kPale{0.62F, 0.68F, 0.76F, 0.22F}, kLines{0.25F, 0.30F, 0.36F, 0.55F};

/// The parts of a picture: what belongs to no group, then the groups.
struct Parts {
  Eigen::Matrix3Xd points;  // scaled to a diagonal of 1, about the origin
  Eigen::Matrix3Xi rest;
  std::vector<std::pair<Eigen::Matrix3Xi, draw::Colour>> groups;
  std::vector<draw::LegendEntry> legend;
};

/// Triangles of a group's elements that are not of the mesh's boundary.
Eigen::Matrix3Xi inner_sides(const Regions& regions, const std::string& name) {
  mesh::TetrahedralMesh part;
  part.nodes = regions.mesh().mesh.nodes;
  part.tetrahedra =
      regions.mesh().mesh.tetrahedra(Eigen::all, regions.members(name, RegionKind::kElements));
  const auto elements = mesh::tetrahedra_by_face(regions.mesh().mesh);
  const Eigen::Matrix3Xi sides = mesh::extract_surface(part).triangles;
  std::vector<int> inner;
  for (int t = 0; t < sides.cols(); ++t) {
    mesh::Face corners{sides(0, t), sides(1, t), sides(2, t)};
    std::sort(corners.begin(), corners.end());
    if (elements.at(corners).size() > 1) inner.push_back(t);
  }
  return sides(Eigen::all, inner);
}

Parts parts_of(const Regions& regions) {
  Parts parts;
  const Eigen::Matrix3Xd& nodes = regions.mesh().mesh.nodes;
  const Vector3d lower = nodes.rowwise().minCoeff(), upper = nodes.rowwise().maxCoeff();
  parts.points = (nodes.colwise() - Vector3d(0.5 * (lower + upper))) / (upper - lower).norm();

  // A face of several groups is shown by what is held there, or by the one of fewest faces.
  std::vector<std::tuple<bool, std::size_t, std::string>> by_size;
  for (const auto& [name, group] : regions.groups())
    by_size.emplace_back(!is_held_region(name), regions.outer_faces(name).size(), name);
  std::sort(by_size.begin(), by_size.end());
  std::vector<bool> is_shown(regions.faces().cols(), false);
  const auto colours = region_colours(regions.groups());
  for (const auto& [is_other, size, name] : by_size) {
    std::vector<int> shown;
    for (const int f : regions.outer_faces(name)) {
      if (is_shown[f]) continue;
      is_shown[f] = true;
      shown.push_back(f);
    }
    const Eigen::Matrix3Xi inner = inner_sides(regions, name);
    Eigen::Matrix3Xi triangles(3, static_cast<int>(shown.size()) + inner.cols());
    triangles << regions.faces()(Eigen::all, shown), inner;
    const Eigen::Vector3f& c = colours.at(name);
    const draw::Colour colour{c[0], c[1], c[2], 1};
    if (triangles.cols() > 0) parts.groups.emplace_back(triangles, colour);
    const RegionSize whole = regions.size(name);
    std::string label = name + ":";
    if (whole.faces > 0) label += common::formatted(" %d faces, %.4g m^2", whole.faces, whole.area);
    if (whole.elements > 0)
      label += common::formatted(" %d elements, %.4g m^3", whole.elements, whole.volume);
    parts.legend.push_back({label, colour});
  }
  if (parts.legend.empty()) parts.legend.push_back({"no groups", kLines});
  parts.rest = regions.faces()(Eigen::all, mesh::indices_of(is_shown, false));
  return parts;
}

draw::Image picture_from(const Vector3d& direction, const Parts& parts) {
  constexpr double kDistance = 2.25;  // in diagonals of the mesh
  draw::Renderer renderer(kView, kViewHeight, /*supersampling=*/2);
  renderer.begin(draw::make_view(kDistance * direction.normalized(), Vector3d::Zero(),
                                 Vector3d::UnitZ(), kViewAngle, kView, kViewHeight));
  draw::MeshStyle style;
  style.shading = draw::Shading::kFlat;
  style.edges = kLines;
  for (const auto& [triangles, colour] : parts.groups) {
    style.colour = colour;
    renderer.draw_mesh(parts.points, triangles, style);
  }
  style.colour = kPale;
  if (parts.rest.cols() > 0) renderer.draw_mesh(parts.points, parts.rest, style);
  return renderer.end();
}

}  // namespace

void draw_regions(const Regions& regions, const std::string& title, const std::string& png) {
  const Parts parts = parts_of(regions);
  draw::Image image(2 * kView + 4, kStrip + kViewHeight);
  std::fill(image.rgb.begin(), image.rgb.end(), std::uint8_t{255});
  draw::paste(picture_from({0.45, -1, 0.5}, parts), 0, kStrip, image);
  draw::paste(picture_from({-0.6, 0.9, 0.6}, parts), kView + 4, kStrip, image);
  draw::draw_title(image, title);
  draw::draw_legend(image, parts.legend);
  draw::write_png(png, image);
}

}  // namespace palpate::mesh_tool
