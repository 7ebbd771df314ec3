#include "sim/draw/renderer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "sim/draw/solids.hpp"

namespace palpate::draw {
namespace {

constexpr double kCrease = 0.7;  // rad, about 40 degrees
// Scaling about the eye leaves a shape in place in the image but moves it in front of the surface
// it lies on: edges in front of their surface, an overlay in front of what it covers. Depth images
// use neither.
constexpr double kLineNearness = 0.997;
constexpr double kOverlayNearness = 0.999;
// The background is a vertical gradient.
constexpr Colour kSkyTop{1, 1, 1, 1}, kSkyBottom{0.86F, 0.89F, 0.93F, 1};

void append(std::vector<float>& values, const Eigen::Vector3d& v) {
  for (const double x : v) values.push_back(static_cast<float>(x));
}

void append(std::vector<float>& values, const Colour& c) {
  values.insert(values.end(), {c.red, c.green, c.blue, c.alpha});
}

/// Key light from the upper left, fill light from the right, both fixed to the camera, so that the
/// scene is well lit from every view. OpenGL eye frame: y up, z towards the viewer.
void set_lights(const OsMesa& gl) {
  const float key_direction[4] = {-0.35F, 0.45F, 1, 0};
  const float key[4] = {0.6F, 0.59F, 0.57F, 1};
  const float shine[4] = {0.18F, 0.18F, 0.18F, 1};
  const float fill_direction[4] = {0.9F, 0.1F, 0.5F, 0};
  const float fill[4] = {0.24F, 0.25F, 0.28F, 1};
  const float none[4] = {0, 0, 0, 1};
  const float ambient[4] = {0.36F, 0.36F, 0.37F, 1};
  gl.light(GL_LIGHT0, GL_POSITION, key_direction);
  gl.light(GL_LIGHT0, GL_DIFFUSE, key);
  gl.light(GL_LIGHT0, GL_SPECULAR, shine);
  gl.light(GL_LIGHT1, GL_POSITION, fill_direction);
  gl.light(GL_LIGHT1, GL_DIFFUSE, fill);
  gl.light(GL_LIGHT1, GL_SPECULAR, none);
  gl.light_model(GL_LIGHT_MODEL_AMBIENT, ambient);
  const float both_sides[1] = {1};
  gl.light_model(GL_LIGHT_MODEL_TWO_SIDE, both_sides);
  const float specular[4] = {1, 1, 1, 1};
  const float shininess[1] = {25};
  gl.material(GL_FRONT_AND_BACK, GL_SPECULAR, specular);
  gl.material(GL_FRONT_AND_BACK, GL_SHININESS, shininess);
  gl.color_material(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
  gl.enable(GL_COLOR_MATERIAL);
  gl.enable(GL_LIGHT0);
  gl.enable(GL_LIGHT1);
}

int checked(int value) {
  if (value < 1) throw std::invalid_argument("renderer: sizes must be positive");
  return value;
}

}  // namespace

Renderer::Renderer(int width, int height, int supersampling)
    : context_(checked(width) * checked(supersampling), checked(height) * supersampling),
      supersampling_(supersampling),
      image_(width, height),
      depth_{width, height, std::vector<float>(std::size_t(width) * height)},
      depth_buffer_(std::size_t(context_.width()) * context_.height()) {}

void Renderer::begin(const View& view) {
  if (!(view.near > 0) || !(view.far > view.near) || !(view.intrinsics.fx > 0) ||
      !(view.intrinsics.fy > 0)) {
    throw std::invalid_argument("renderer: needs 0 < near < far and positive focal lengths");
  }
  view_ = view;
  batches_.clear();
}

void Renderer::draw_mesh(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                         const MeshStyle& style) {
  if (triangles.cols() == 0) return;
  if (triangles.minCoeff() < 0 || triangles.maxCoeff() >= points.cols()) {
    throw std::invalid_argument("renderer: a triangle names a point that does not exist");
  }
  const bool painted = !style.vertex_colours.empty();
  if (painted && static_cast<Eigen::Index>(style.vertex_colours.size()) != points.cols()) {
    throw std::invalid_argument("renderer: needs one colour per point, or none");
  }
  Batch batch;
  batch.translucent = !painted && style.colour.alpha < 1;
  const Eigen::Matrix3Xd normals =
      corner_normals(points, triangles, style.shading == Shading::kSmooth ? kCrease : 0);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int point = triangles(i, t);
      append(batch.positions, points.col(point));
      append(batch.normals, normals.col(3 * t + i));
      const Colour& colour = painted ? style.vertex_colours[point] : style.colour;
      append(batch.colours, colour);
      batch.translucent = batch.translucent || colour.alpha < 1;
    }
  }
  batches_.push_back(std::move(batch));
  if (style.edges) add_edges(points, triangles, style);
}

void Renderer::add_edges(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                         const MeshStyle& style) {
  std::set<std::pair<int, int>> edges;
  for (const auto& triangle : triangles.colwise()) {
    for (int i = 0; i < 3; ++i)
      edges.insert(std::minmax(int{triangle[i]}, int{triangle[(i + 1) % 3]}));
  }
  Batch batch;
  batch.lines = true;
  batch.translucent = style.edges->alpha < 1;
  for (const auto& [from, to] : edges) {
    append(batch.positions, points.col(from));
    append(batch.positions, points.col(to));
    append(batch.colours, *style.edges);
    append(batch.colours, *style.edges);
  }
  batches_.push_back(std::move(batch));
}

void Renderer::draw_solid(const math::Pose& X_WB, TriangleMesh mesh, const Colour& colour) {
  mesh.points = (X_WB.linear() * mesh.points).colwise() + X_WB.translation();
  MeshStyle style;
  style.colour = colour;
  draw_mesh(mesh.points, mesh.triangles, style);
}

void Renderer::draw_box(const math::Pose& X_WB, const Eigen::Vector3d& size, const Colour& colour) {
  draw_solid(X_WB, make_box(size), colour);
}

void Renderer::draw_cylinder(const math::Pose& X_WB, double radius, double length,
                             const Colour& colour) {
  draw_solid(X_WB, make_cylinder(radius, length), colour);
}

void Renderer::draw_sphere(const math::Pose& X_WB, double radius, const Colour& colour) {
  draw_solid(X_WB, make_sphere(radius), colour);
}

void Renderer::draw_arrow(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                          double shaft_radius, const Colour& colour) {
  const Eigen::Vector3d along = to - from;
  const double length = along.norm();
  if (!(length > 0)) return;
  math::Pose X_WA = math::Pose::Identity();
  X_WA.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), along).toRotationMatrix();
  X_WA.translation() = from;
  draw_solid(X_WA, make_arrow(length, shaft_radius), colour);
}

void Renderer::draw_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width_px,
                         const Colour& colour) {
  Batch batch;
  batch.lines = true;
  batch.translucent = colour.alpha < 1;
  batch.line_width = static_cast<float>(width_px);
  append(batch.positions, from);
  append(batch.positions, to);
  append(batch.colours, colour);
  append(batch.colours, colour);
  batches_.push_back(std::move(batch));
}

void Renderer::set_projection() {
  const OsMesa& gl = context_.gl();
  const Intrinsics& k = view_.intrinsics;
  const double near = view_.near;
  const double far = view_.far;
  // The centre of pixel 0 lies half a pixel inside the image, hence the odd numbers.
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = 2 * k.fx / image_.width;
  projection(0, 2) = 1 - (2 * k.cx + 1) / image_.width;
  projection(1, 1) = 2 * k.fy / image_.height;
  projection(1, 2) = (2 * k.cy + 1) / image_.height - 1;
  projection(2, 2) = -(far + near) / (far - near);
  projection(2, 3) = -2 * far * near / (far - near);
  projection(3, 2) = -1;
  Eigen::Matrix4d eye_from_world = view_.X_WC.inverse().matrix();
  eye_from_world.row(1) *= -1;  // OpenGL looks along -z with y up, a camera along z with y down
  eye_from_world.row(2) *= -1;

  gl.viewport(0, 0, context_.width(), context_.height());
  gl.matrix_mode(GL_PROJECTION);
  gl.load_matrix(projection.data());
  gl.matrix_mode(GL_MODELVIEW);
  gl.load_identity();
  set_lights(gl);  // in the eye frame
  eye_from_world_ = eye_from_world;
}

template <class Predicate>
void Renderer::paint_if(Predicate wanted, double nearness) {
  Eigen::Matrix4d model_view = eye_from_world_;
  model_view.topRows<3>() *= nearness;
  context_.gl().load_matrix(model_view.data());
  for (const Batch& batch : batches_) {
    if (wanted(batch)) paint(batch);
  }
}

void Renderer::paint_background() {
  const OsMesa& gl = context_.gl();
  gl.matrix_mode(GL_PROJECTION);
  gl.load_identity();
  gl.matrix_mode(GL_MODELVIEW);
  gl.load_identity();
  Batch sky;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
    append(sky.positions, Eigen::Vector3d(x, y, 0));
    append(sky.colours, y > 0 ? kSkyTop : kSkyBottom);
  }
  gl.disable(GL_DEPTH_TEST);
  gl.disable(GL_LIGHTING);
  gl.disable(GL_BLEND);
  gl.vertex_pointer(3, GL_FLOAT, 0, sky.positions.data());
  gl.color_pointer(4, GL_FLOAT, 0, sky.colours.data());
  gl.draw_arrays(GL_TRIANGLES, 0, 6);
}

void Renderer::paint(const Batch& batch) {
  const OsMesa& gl = context_.gl();
  const auto count = static_cast<GLsizei>(batch.positions.size() / 3);
  gl.vertex_pointer(3, GL_FLOAT, 0, batch.positions.data());
  gl.color_pointer(4, GL_FLOAT, 0, batch.colours.data());
  if (batch.lines) {
    gl.disable(GL_LIGHTING);
    gl.line_width(batch.line_width * static_cast<float>(supersampling_));
    gl.draw_arrays(GL_LINES, 0, count);
    return;
  }
  gl.enable(GL_LIGHTING);
  gl.enable_client_state(GL_NORMAL_ARRAY);
  gl.normal_pointer(GL_FLOAT, 0, batch.normals.data());
  if (batch.translucent) {
    // Depth only in the first pass: then only the front of the body is blended, not its back
    // through it.
    gl.color_mask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl.draw_arrays(GL_TRIANGLES, 0, count);
    gl.color_mask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  gl.draw_arrays(GL_TRIANGLES, 0, count);
  gl.disable_client_state(GL_NORMAL_ARRAY);
}

const Image& Renderer::end() {
  const OsMesa& gl = context_.gl();
  context_.make_current();
  gl.depth_mask(GL_TRUE);
  gl.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl.enable_client_state(GL_VERTEX_ARRAY);
  gl.enable_client_state(GL_COLOR_ARRAY);
  paint_background();
  gl.enable(GL_DEPTH_TEST);
  gl.depth_func(GL_LEQUAL);

  set_projection();
  paint_if([](const Batch& b) { return !b.translucent && !b.lines; }, 1);
  read_depth();
  paint_if([](const Batch& b) { return !b.translucent && b.lines; }, kLineNearness);
  gl.enable(GL_BLEND);
  gl.blend_func(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  paint_if([](const Batch& b) { return b.translucent && !b.lines; }, kOverlayNearness);
  paint_if([](const Batch& b) { return b.translucent && b.lines; }, kLineNearness);
  gl.finish();
  if (gl.get_error() != GL_NO_ERROR) throw std::runtime_error("renderer: OpenGL reports an error");
  read_colours();
  return image_;
}

void Renderer::read_depth() {
  context_.gl().read_pixels(0, 0, context_.width(), context_.height(), GL_DEPTH_COMPONENT, GL_FLOAT,
                            depth_buffer_.data());
  const double near = view_.near;
  const double far = view_.far;
  const int middle = supersampling_ / 2;
  for (int row = 0; row < depth_.height; ++row) {
    const int from_bottom = context_.height() - 1 - (row * supersampling_ + middle);
    for (int column = 0; column < depth_.width; ++column) {
      const double window = depth_buffer_[std::size_t(from_bottom) * context_.width() +
                                          column * supersampling_ + middle];
      const double metres = near * far / (far - window * (far - near));
      depth_.metres[std::size_t(row) * depth_.width + column] =
          window < 1 ? static_cast<float>(metres) : 0;
    }
  }
}

void Renderer::read_colours() {
  const std::vector<unsigned char>& rgba = context_.pixels();
  const int samples = supersampling_ * supersampling_;
  for (int row = 0; row < image_.height; ++row) {
    if (samples == 1) {
      const unsigned char* sample =
          &rgba[4 * std::size_t(context_.height() - 1 - row) * context_.width()];
      std::uint8_t* pixel = image_.pixel(0, row);
      for (int column = 0; column < image_.width; ++column, sample += 4, pixel += 3)
        std::copy_n(sample, 3, pixel);
      continue;
    }
    for (int column = 0; column < image_.width; ++column) {
      int sum[3] = {};
      for (int s = 0; s < samples; ++s) {
        const int y = context_.height() - 1 - (row * supersampling_ + s / supersampling_);
        const int x = column * supersampling_ + s % supersampling_;
        const unsigned char* sample = &rgba[4 * (std::size_t(y) * context_.width() + x)];
        for (int channel = 0; channel < 3; ++channel) sum[channel] += sample[channel];
      }
      std::uint8_t* pixel = image_.pixel(column, row);
      for (int channel = 0; channel < 3; ++channel) {
        pixel[channel] = static_cast<std::uint8_t>((sum[channel] + samples / 2) / samples);
      }
    }
  }
}

}  // namespace palpate::draw
