#include "tools/mesh/faults.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/mesh/near_nodes.hpp"
#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/renderer.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

using draw::Colour;
using Eigen::Vector3d;

constexpr int kPanel = 760, kHeight = 700, kTitle = 34, kSupersampling = 2;  // px
constexpr double kFieldOfView = 0.5;                                         // rad
constexpr std::size_t kMostBalls = 30, kMostSingleBalls = 400;               // of a kind

const Colour kBody{0.62F, 0.68F, 0.76F, 0.16F}, kWire{0.35F, 0.42F, 0.50F, 0.55F};
const Colour kDark{0.25F, 0.02F, 0.02F, 1};
// The first kinds of faults; red is the most severe.
const Colour kColours[] = {{0.86F, 0.08F, 0.10F, 1}, {0.95F, 0.55F, 0.05F, 1},
                           {0.55F, 0.15F, 0.75F, 1}, {0.05F, 0.50F, 0.30F, 1},
                           {0.05F, 0.35F, 0.80F, 1}, {0.55F, 0.40F, 0.10F, 1}};

Colour colour_of(std::size_t kind) { return kColours[std::min(kind, std::size(kColours) - 1)]; }

/// The body and its faults, scaled to a diagonal of 1 and centred at the origin, for which the
/// camera is set up.
class Scene {
 public:
  Scene(const mesh::TriangleSurface& body, const std::vector<Fault>& faults)
      : body_(body), faults_(faults) {
    Eigen::AlignedBox3d box;
    for (int n = 0; n < body.point_count(); ++n) {
      if (body.points.col(n).allFinite()) box.extend(Vector3d(body.points.col(n)));
    }
    // Faults without a body around them, or far away from it.
    for (const Fault& fault : faults) {
      for (const Vector3d& p : fault.points) {
        if (p.allFinite()) box.extend(p);
      }
      for (const auto& [a, b] : fault.lines) {
        box.extend(a);
        box.extend(b);
      }
    }
    if (!box.isEmpty() && box.diagonal().norm() > 0) {
      centre_ = box.center();
      scale_ = 1 / box.diagonal().norm();
    }
    body_.points = scaled(body.points);
  }

  draw::Image whole() const {
    const Vector3d direction = Vector3d(0.45, -1, 0.5).normalized();
    return draw(Vector3d::Zero(), direction, 2.25, 0.008, "");
  }

  /// View from outside on the first location of the first fault that has one.
  draw::Image close_up() const {
    for (std::size_t kind = 0; kind < faults_.size(); ++kind) {
      const Fault& fault = faults_[kind];
      if (fault.points.empty() || !fault.points.front().allFinite()) continue;
      const Vector3d place = place_of(fault.points.front());
      double size = 0.02;
      if (!fault.faces.empty()) size = std::max(size, mesh::diagonal(scaled(fault.faces.front())));
      if (!fault.lines.empty()) {
        const auto& [a, b] = fault.lines.front();
        size = std::max(size, scale_ * (b - a).norm());
      }
      Vector3d direction = Vector3d(0.45, -1, 0.5).normalized();
      if (place.norm() > 0.05) direction = (direction + 1.5 * place.normalized()).normalized();
      const double distance = std::clamp(7 * size, 0.6, 1.6);
      std::string label = "from near: " + fault.kind;
      if (!fault.numbers.empty() && fault.numbers.front() >= 0)
        label += " " + std::to_string(fault.numbers.front());
      return draw(place, direction, distance, 0.0035 * distance, label);
    }
    return draw(Vector3d::Zero(), Vector3d(-0.6, 0.9, 0.6).normalized(), 2.25, 0.008,
                "from behind");
  }

 private:
  Eigen::Matrix3Xd scaled(const Eigen::Matrix3Xd& points) const {
    return scale_ * (points.colwise() - centre_);
  }
  Vector3d place_of(const Vector3d& p) const { return scale_ * (p - centre_); }

  draw::Image draw(const Vector3d& target, const Vector3d& direction, double distance, double ball,
                   const std::string& label) const {
    draw::Renderer renderer(kPanel, kHeight, kSupersampling);
    const draw::View view = draw::make_view(target + distance * direction, target,
                                            Vector3d::UnitZ(), kFieldOfView, kPanel, kHeight);
    renderer.begin(view);
    draw::MeshStyle style;
    style.colour = kBody;
    style.edges = kWire;
    if (body_.triangle_count() > 0) renderer.draw_mesh(body_.points, body_.triangles, style);
    for (std::size_t kind = faults_.size(); kind-- > 0;) draw(renderer, kind, ball);
    draw::Image image = renderer.end();
    for (std::size_t kind = faults_.size(); kind-- > 0;) frame(image, kind, view);
    if (!label.empty()) draw::draw_text(image, 12, 12, label, Colour{0.15F, 0.18F, 0.22F, 1}, 2);
    return image;
  }

  void draw(draw::Renderer& renderer, std::size_t kind, double ball) const {
    const Fault& fault = faults_[kind];
    draw::MeshStyle style;
    // Less severe faults must not hide the most severe one.
    const Colour colour = colour_of(kind);
    style.colour = colour;
    style.colour.alpha = kind == 0 ? 1.0F : 0.45F;
    style.edges = kDark;
    style.shading = draw::Shading::kFlat;
    if (!fault.faces.empty()) {
      Eigen::Matrix3Xd points(3, 3 * static_cast<int>(fault.faces.size()));
      Eigen::Matrix3Xi triangles(3, 2 * static_cast<int>(fault.faces.size()));
      for (int f = 0; f < static_cast<int>(fault.faces.size()); ++f) {
        points.middleCols<3>(3 * f) = scaled(fault.faces[f]);
        triangles.col(2 * f) << 3 * f, 3 * f + 1, 3 * f + 2;
        triangles.col(2 * f + 1) << 3 * f, 3 * f + 2, 3 * f + 1;  // visible from either side
      }
      renderer.draw_mesh(points, triangles, style);
    }
    for (const auto& [a, b] : fault.lines) renderer.draw_line(place_of(a), place_of(b), 5, colour);
    // If there are many they are visible without a mark.
    if (fault.points.size() > kMostBalls && !fault.faces.empty()) return;
    for (std::size_t i = 0; i < std::min(kMostSingleBalls, fault.points.size()); ++i) {
      if (!fault.points[i].allFinite()) continue;
      math::Pose at = math::Pose::Identity();
      at.translation() = place_of(fault.points[i]);
      renderer.draw_sphere(at, ball, colour);
    }
  }

  /// A square around each location if there are few, regardless of what occludes it.
  void frame(draw::Image& image, std::size_t kind, const draw::View& view) const {
    constexpr int kHalf = 11, kLine = 3;  // px
    if (faults_[kind].points.size() > kMostBalls) return;
    for (const Vector3d& point : faults_[kind].points) {
      if (!point.allFinite()) continue;
      const Vector3d p = view.X_WC.inverse() * place_of(point);
      if (p.z() < view.near) continue;
      const double x = view.intrinsics.fx * p.x() / p.z() + view.intrinsics.cx,
                   y = view.intrinsics.fy * p.y() / p.z() + view.intrinsics.cy;
      if (!(x > kHalf && x < kPanel - kHalf && y > kHalf && y < kHeight - kHalf)) continue;
      const int left = static_cast<int>(x) - kHalf, top = static_cast<int>(y) - kHalf;
      const Colour colour = colour_of(kind);
      draw::draw_rectangle(image, left, top, 2 * kHalf, kLine, colour);
      draw::draw_rectangle(image, left, top + 2 * kHalf - kLine, 2 * kHalf, kLine, colour);
      draw::draw_rectangle(image, left, top, kLine, 2 * kHalf, colour);
      draw::draw_rectangle(image, left + 2 * kHalf - kLine, top, kLine, 2 * kHalf, colour);
    }
  }

  mesh::TriangleSurface body_;
  const std::vector<Fault>& faults_;
  Vector3d centre_ = Vector3d::Zero();
  double scale_ = 1;
};

/// Cells whose corners all exist and are finite.
std::vector<int> drawable(const Eigen::Ref<const Eigen::MatrixXi>& cells,
                          const Eigen::Matrix3Xd& points) {
  std::vector<int> kept;
  for (int cell = 0; cell < cells.cols(); ++cell) {
    const auto corners = cells.col(cell);
    if (std::all_of(corners.begin(), corners.end(), [&points](int n) {
          return n >= 0 && n < points.cols() && points.col(n).allFinite();
        }))
      kept.push_back(cell);
  }
  return kept;
}

}  // namespace

mesh::TriangleSurface background(const mesh::MeshWithGroups& mesh) {
  mesh::TetrahedralMesh sound;
  sound.nodes = mesh.mesh.nodes;
  sound.tetrahedra = mesh.mesh.tetrahedra(Eigen::all, drawable(mesh.mesh.tetrahedra, sound.nodes));
  mesh::orient(sound);
  return boundary(sound);
}

mesh::TriangleSurface background(const mesh::TriangleSurface& surface) {
  mesh::TriangleSurface sound;
  sound.points = surface.points;
  sound.triangles = surface.triangles(Eigen::all, drawable(surface.triangles, surface.points));
  for (double& coordinate : sound.points.reshaped()) {
    if (!std::isfinite(coordinate)) coordinate = 0;  // of points that belong to no drawn triangle
  }
  return sound;
}

void draw_faults(const mesh::TriangleSurface& body, const std::vector<Fault>& faults,
                 const std::string& title, const std::filesystem::path& png) {
  const Scene scene(body, faults);
  draw::Image image(2 * kPanel + 4, kTitle + kHeight);
  std::fill(image.rgb.begin(), image.rgb.end(), std::uint8_t{255});
  draw::paste(scene.whole(), 0, kTitle, image);
  draw::paste(scene.close_up(), kPanel + 4, kTitle, image);
  draw::draw_title(image, title);
  std::vector<draw::LegendEntry> legend;
  for (std::size_t kind = 0; kind < faults.size(); ++kind) {
    const Fault& fault = faults[kind];
    if (fault.points.empty() && fault.faces.empty() && fault.lines.empty()) continue;
    std::string label = fault.text;
    if (!fault.numbers.empty()) label += ": " + std::to_string(fault.numbers.size());
    constexpr std::size_t kLongest = 115;
    if (label.size() > kLongest) label = label.substr(0, kLongest - 3) + "...";
    legend.push_back({label, colour_of(kind)});
  }
  if (faults.empty()) legend.push_back({"no faults found", kWire});
  draw::draw_legend(image, legend);
  draw::write_png(png.string(), image);
}

}  // namespace palpate::mesh_tool
