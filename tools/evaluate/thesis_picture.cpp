#include "tools/evaluate/thesis_picture.hpp"

#include <algorithm>

#include "sim/camera/annotate.hpp"
#include "sim/camera/png_file.hpp"
#include "sim/camera/renderer.hpp"

namespace palpate::evaluate {
namespace {

constexpr int kWidth = 520, kHeight = 420, kSupersampling = 2;
constexpr double kFieldOfView = 0.40;  // rad
constexpr double kDot = 1.8e-3;        // m, half a dot's size

const camera::Colour kMeasured{0.88F, 0.55F, 0.10F, 1};
const camera::Colour kSolid{0.45F, 0.60F, 0.90F, 1};
const camera::Colour kGlass{0.10F, 0.30F, 0.85F, 0.28F};
const camera::Colour kEdge{0.05F, 0.18F, 0.65F, 1};

/// An octahedron for each point of a cloud.
camera::TriangleMesh dots(const Eigen::Matrix3Xd& cloud) {
  Eigen::Matrix<double, 3, 6> corners;
  corners << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  Eigen::Matrix<int, 3, 8> faces;
  faces << 0, 1, 0, 1, 3, 4, 3, 4,  //
      1, 3, 5, 0, 4, 0, 1, 3,       //
      2, 2, 1, 5, 2, 2, 5, 5;
  camera::TriangleMesh mesh;
  mesh.points.resize(3, 6 * cloud.cols());
  mesh.triangles.resize(3, 8 * cloud.cols());
  for (int i = 0; i < cloud.cols(); ++i) {
    mesh.points.middleCols<6>(6 * i) = (kDot * corners).colwise() + cloud.col(i);
    mesh.triangles.middleCols<8>(8 * i) = faces.array() + 6 * i;
  }
  return mesh;
}

void copy_panel(camera::Image& into, const camera::Image& panel, int column) {
  for (int row = 0; row < panel.height; ++row)
    std::copy_n(panel.pixel(0, row), 3 * panel.width, into.pixel(column, row));
}

}  // namespace

void draw_state(const StateShapes& shapes, const math::Pose& X_WO, const std::string& title,
                const std::filesystem::path& png) {
  const Eigen::Matrix3Xd cloud = transformed(X_WO, shapes.measured);
  const Eigen::Matrix3Xd estimate = transformed(X_WO, shapes.estimate.points);
  const camera::TriangleMesh dotted = dots(cloud);
  const Eigen::Matrix3Xd truth = transformed(X_WO, shapes.truth.points);
  const Eigen::Vector3d lower = truth.rowwise().minCoeff(), upper = truth.rowwise().maxCoeff();
  const Eigen::Vector3d middle = 0.5 * (lower + upper);
  const double distance = 1.0 * (upper - lower).norm() / kFieldOfView;
  const Eigen::Vector3d eye = middle + distance * Eigen::Vector3d(-0.22, -0.92, 0.33).normalized();

  camera::Renderer renderer(kWidth, kHeight, kSupersampling);
  const auto panel = [&](bool with_cloud, bool with_estimate, const std::string& text) {
    renderer.begin(
        camera::make_view(eye, middle, Eigen::Vector3d::UnitZ(), kFieldOfView, kWidth, kHeight));
    camera::MeshStyle style;
    style.shading = camera::Shading::kFlat;
    style.colour = kMeasured;
    if (with_cloud) renderer.draw_mesh(dotted.points, dotted.triangles, style);
    style.colour = with_cloud ? kGlass : kSolid;
    style.edges = kEdge;
    if (with_estimate) renderer.draw_mesh(estimate, shapes.estimate.triangles, style);
    camera::Image image = renderer.end();
    camera::draw_title(image, text);
    return image;
  };
  camera::Image image(3 * kWidth, kHeight);
  copy_panel(image, panel(true, false, title + (shapes.camera ? ": camera" : ": true surface")), 0);
  copy_panel(image, panel(false, true, "estimate"), kWidth);
  copy_panel(image, panel(true, true, "both"), 2 * kWidth);
  camera::write_png(png.string(), image);
}

}  // namespace palpate::evaluate
