#include "tools/lab/studies/study_picture.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/renderer.hpp"

namespace palpate::studies {
namespace {

constexpr int kWidth = 520, kHeight = 460, kSupersampling = 2;
constexpr double kFieldOfView = 0.40;  // rad
// Fractions of a panel available to the shapes: the rest is for title and legend.
constexpr double kFilledWidth = 0.88, kFilledHeight = 0.73;
constexpr double kDot = 1.8e-3;  // m, half a dot's size
constexpr double kAxis = 0.05;   // m

const draw::Colour kMeasured{0.88F, 0.55F, 0.10F, 1};
const draw::Colour kSolid{0.45F, 0.60F, 0.90F, 1};
const draw::Colour kGlass{0.10F, 0.30F, 0.85F, 0.28F};
const draw::Colour kEdge{0.05F, 0.18F, 0.65F, 1};

/// An octahedron for each point of a cloud.
draw::TriangleMesh dots(const Eigen::Matrix3Xd& cloud) {
  Eigen::Matrix<double, 3, 6> corners;
  corners << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  Eigen::Matrix<int, 3, 8> faces;
  faces << 0, 1, 0, 1, 3, 4, 3, 4,  //
      1, 3, 5, 0, 4, 0, 1, 3,       //
      2, 2, 1, 5, 2, 2, 5, 5;
  draw::TriangleMesh mesh;
  mesh.points.resize(3, 6 * cloud.cols());
  mesh.triangles.resize(3, 8 * cloud.cols());
  for (int i = 0; i < cloud.cols(); ++i) {
    mesh.points.middleCols<6>(6 * i) = (kDot * corners).colwise() + cloud.col(i);
    mesh.triangles.middleCols<8>(8 * i) = faces.array() + 6 * i;
  }
  return mesh;
}

/// The closest view along `towards_eye` that contains all points, centred on their bounding box.
draw::View view_of(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& towards_eye) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d middle = 0.5 * (points.rowwise().minCoeff() + points.rowwise().maxCoeff());
  const Eigen::Vector3d right = up.cross(towards_eye).normalized();
  const Eigen::Vector3d above = towards_eye.cross(right);
  const double half = std::tan(0.5 * kFieldOfView);
  const double vertical = kFilledHeight * half;
  const double horizontal = kFilledWidth * half * kWidth / kHeight;
  double distance = 0;
  for (const auto& point : points.colwise()) {
    const Eigen::Vector3d r = point - middle;
    distance = std::max({distance, r.dot(towards_eye) + std::abs(r.dot(right)) / horizontal,
                         r.dot(towards_eye) + std::abs(r.dot(above)) / vertical});
  }
  return draw::make_view(middle + distance * towards_eye, middle, up, kFieldOfView, kWidth,
                         kHeight);
}

/// Position at which the axes of O are drawn: behind the clamp, clear of the shapes.
math::Pose place_of_axes(const math::Pose& X_WO) {
  math::Pose at = X_WO;
  at.translation() = X_WO * Eigen::Vector3d(-1.4 * kAxis, 0, 0);
  return at;
}

/// They show directions and scale.
void draw_axes(draw::Renderer& renderer, const math::Pose& at) {
  const draw::Colour colours[] = {
      {0.80F, 0.10F, 0.10F, 1}, {0.10F, 0.60F, 0.15F, 1}, {0.15F, 0.25F, 0.90F, 1}};
  for (int i = 0; i < 3; ++i)
    renderer.draw_line(at.translation(), at * (kAxis * Eigen::Vector3d::Unit(i)), 4, colours[i]);
}

std::string errors_of(const StateScore& state) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "mean " << state.error.mean * 1e3 << " mm, max "
       << state.error.maximum * 1e3 << " mm";
  return text.str();
}

void copy_panel(draw::Image& into, const draw::Image& panel, int column) {
  for (int row = 0; row < panel.height; ++row)
    std::copy_n(panel.pixel(0, row), 3 * panel.width, into.pixel(column, row));
}

}  // namespace

void draw_state(const StateScore& state, const math::Pose& X_WO, const std::filesystem::path& png) {
  const StateShapes& shapes = state.shapes;
  const Eigen::Matrix3Xd estimate = log::transformed(X_WO, shapes.estimate.points);
  const draw::TriangleMesh dotted = dots(log::transformed(X_WO, shapes.measured));
  const math::Pose axes = place_of_axes(X_WO);
  Eigen::Matrix3Xd all(3, estimate.cols() + shapes.truth.points.cols() + 1);
  all << estimate, log::transformed(X_WO, shapes.truth.points), axes.translation();
  const draw::View view = view_of(all, Eigen::Vector3d(-0.22, -0.92, 0.33).normalized());

  draw::Renderer renderer(kWidth, kHeight, kSupersampling);
  const auto panel = [&](bool with_cloud, bool with_estimate, const std::string& title,
                         const std::vector<draw::LegendEntry>& legend) {
    renderer.begin(view);
    draw_axes(renderer, axes);
    draw::MeshStyle style;
    style.shading = draw::Shading::kFlat;
    style.colour = kMeasured;
    if (with_cloud) renderer.draw_mesh(dotted.points, dotted.triangles, style);
    style.colour = with_cloud ? kGlass : kSolid;
    style.edges = kEdge;
    if (with_estimate) renderer.draw_mesh(estimate, shapes.estimate.triangles, style);
    draw::Image image = renderer.end();
    draw::draw_title(image, title);
    draw::draw_legend(image, legend);
    return image;
  };
  const draw::LegendEntry measured{
      shapes.camera ? "measured by the camera" : "true surface of the plant", kMeasured};
  const draw::LegendEntry estimated{"estimate", kEdge};
  draw::Image image(3 * kWidth, kHeight);
  copy_panel(image, panel(true, false, state.name, {measured}), 0);
  copy_panel(image, panel(false, true, "axes: x red, y green, z blue, 50 mm", {estimated}), kWidth);
  copy_panel(image, panel(true, true, errors_of(state), {measured, estimated}), 2 * kWidth);
  draw::write_png(png.string(), image);
}

}  // namespace palpate::studies
