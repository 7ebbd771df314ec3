#include "shape_view.hpp"

namespace palpate::drake_bridge {
namespace {

constexpr std::int8_t kTriangles = 4;  // lcmt_viewer_geometry_data.type

}  // namespace

ShapeView::ShapeView(const Options& options) : surface_(options.rate) {
  message_.name = "palpate";
  message_.num_geom = 1;
  message_.geom.resize(1);
  ::drake::lcmt_viewer_geometry_data& geometry = message_.geom[0];
  geometry.type = kTriangles;
  geometry.string_data = "shape";
  double quaternion[4];
  math::wxyz_from_rotation(options.X_WO.linear(), quaternion);
  for (int i = 0; i < 3; ++i)
    geometry.position[i] = static_cast<float>(options.X_WO.translation()[i]);
  for (int i = 0; i < 4; ++i) {
    geometry.quaternion[i] = static_cast<float>(quaternion[i]);
    geometry.color[i] = static_cast<float>(options.color[i]);
  }
}

bool ShapeView::take(std::string_view channel, const void* data, int size, std::int64_t utime) {
  if (!surface_.take(channel, data, size, utime)) return false;
  // Numbers of vertices and triangles, then both.
  std::vector<float>& numbers = message_.geom[0].float_data;
  numbers.assign({static_cast<float>(surface_.vertices().size() / 3),
                  static_cast<float>(surface_.triangles().size() / 3)});
  numbers.insert(numbers.end(), surface_.vertices().begin(), surface_.vertices().end());
  for (const std::int32_t vertex : surface_.triangles())
    numbers.push_back(static_cast<float>(vertex));
  message_.geom[0].num_float_data = static_cast<std::int32_t>(numbers.size());
  return true;
}

}  // namespace palpate::drake_bridge
