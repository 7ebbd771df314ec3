#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/osmesa.hpp"
#include "sim/draw/solids.hpp"
#include "sim/draw/view.hpp"

namespace palpate::draw {

enum class Shading {
  kFlat,   // one normal per triangle
  kSmooth  // averaged over neighbours that meet at less than 40 degrees: edges stay sharp
};

/// How a mesh is rendered.
struct MeshStyle {
  Colour colour{0.7F, 0.7F, 0.7F, 1};
  Shading shading = Shading::kSmooth;
  std::optional<Colour> edges;         // wireframe of the triangles, if requested
  std::vector<Colour> vertex_colours;  // one per point instead of `colour`, or empty
};

/// Renders off-screen colour and depth images through OSMesa. Between begin() and end() shapes are
/// only collected; end() draws them, opaque ones first, then those with alpha below 1 in the given
/// order, so that an estimate can be overlaid on the ground truth. Not thread-safe.
class Renderer {
 public:
  /// Size in px. Each pixel's colour is the mean of supersampling^2 samples (1: none, suitable for
  /// depth cameras; 2: smooth edges for images). Throws std::runtime_error without OSMesa.
  Renderer(int width, int height, int supersampling = 1);

  /// Starts an image.
  void begin(const View& view);

  /// points: 3 x n in W, m; triangles: 3 x m vertex indices, oriented outward by the right-hand
  /// rule. Throws std::invalid_argument if an index or the number of colours is wrong.
  void draw_mesh(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                 const MeshStyle& style);

  /// Solids at pose X_WB: full side lengths; length along z, centred, as in URDF.
  void draw_box(const math::Pose& X_WB, const Eigen::Vector3d& size, const Colour& colour);
  void draw_cylinder(const math::Pose& X_WB, double radius, double length, const Colour& colour);
  void draw_sphere(const math::Pose& X_WB, double radius, const Colour& colour);
  void draw_arrow(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double shaft_radius,
                  const Colour& colour);
  void draw_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width_px,
                 const Colour& colour);

  /// Draws. The colour image and the depth of its opaque part are valid until the next end().
  const Image& end();
  const DepthImage& depth() const { return depth_; }

 private:
  /// Triangles or lines, three or two vertices each, in the graphics library's layout.
  struct Batch {
    bool lines = false;
    bool translucent = false;
    float line_width = 1;
    std::vector<float> positions;
    std::vector<float> normals;  // empty for lines
    std::vector<float> colours;  // red, green, blue, alpha
  };

  void draw_solid(const math::Pose& X_WB, TriangleMesh mesh, const Colour& colour);
  void add_edges(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                 const MeshStyle& style);
  void set_projection();
  void paint_background();
  template <class Predicate>
  void paint_if(Predicate wanted, double nearness);
  void paint(const Batch& batch);
  void read_depth();
  void read_colours();

  OsMesaContext context_;
  int supersampling_;
  View view_;
  Eigen::Matrix4d eye_from_world_ = Eigen::Matrix4d::Identity();
  std::vector<Batch> batches_;
  Image image_;
  DepthImage depth_;
  std::vector<float> depth_buffer_;
};

}  // namespace palpate::draw
