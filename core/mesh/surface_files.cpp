#include "core/mesh/surface_files.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <sstream>

#include "core/mesh/mesh_writer.hpp"

namespace palpate::mesh {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // sizes in a binary STL, bytes

/// Points by their coordinates, so that triangles share them. Each non-finite point, which is equal
/// to none, is separate.
class PointSet {
 public:
  int add(const Eigen::Vector3d& p) {
    if (p.allFinite()) {
      const auto [found, is_new] =
          known_.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(points_.size()));
      if (!is_new) return found->second;
    }
    points_.push_back(p);
    return static_cast<int>(points_.size()) - 1;
  }
  Eigen::Matrix3Xd matrix() const {
    Eigen::Matrix3Xd result(3, static_cast<int>(points_.size()));
    for (int n = 0; n < result.cols(); ++n) result.col(n) = points_[n];
    return result;
  }

 private:
  std::map<std::array<double, 3>, int> known_;
  std::vector<Eigen::Vector3d> points_;
};

TriangleSurface gather(const Eigen::Matrix3Xd& points,
                       const std::vector<Eigen::Vector3i>& triangles, std::vector<long> numbers) {
  TriangleSurface surface{points, Eigen::Matrix3Xi(3, static_cast<int>(triangles.size())),
                          std::move(numbers)};
  for (int t = 0; t < surface.triangle_count(); ++t) surface.triangles.col(t) = triangles[t];
  return surface;
}

std::vector<long> counted(std::size_t count) {
  std::vector<long> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<long>(i) + 1;
  return numbers;
}

TriangleSurface read_binary_stl(const std::string& bytes, std::uint32_t count) {
  PointSet points;
  std::vector<Eigen::Vector3i> triangles;
  for (std::uint32_t t = 0; t < count; ++t) {
    float numbers[12];  // normal, three corners
    std::memcpy(numbers, &bytes[kHeader + kFacet * t], sizeof numbers);
    Eigen::Vector3i& corners = triangles.emplace_back();
    for (int i = 0; i < 3; ++i) {
      corners[i] = points.add({numbers[3 + 3 * i], numbers[4 + 3 * i], numbers[5 + 3 * i]});
    }
  }
  return gather(points.matrix(), triangles, counted(triangles.size()));
}

TriangleSurface read_ascii_stl(const std::string& bytes, const std::string& name) {
  std::istringstream stream(bytes);
  LineReader reader(stream, name, '\0');
  PointSet points;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> corners;
  while (reader.next()) {
    const std::string& word = reader.words()[0];
    if (word == "vertex") {
      corners.push_back(points.add({reader.number(1), reader.number(2), reader.number(3)}));
    } else if (word == "endfacet") {
      if (corners.size() != 3) {
        reader.fail("a facet has " + std::to_string(corners.size()) + " vertices, not 3");
      }
      triangles.emplace_back(corners[0], corners[1], corners[2]);
      corners.clear();
    } else if (word != "facet" && word != "outer" && word != "endloop" && word != "solid" &&
               word != "endsolid") {
      reader.fail("'" + word + "' is no word of an STL");
    }
  }
  if (!corners.empty()) reader.fail("the file ends within a facet");
  return gather(points.matrix(), triangles, counted(triangles.size()));
}

}  // namespace

double enclosed_volume(const TriangleSurface& surface) {
  if (surface.triangle_count() == 0) return 0;
  const Eigen::Vector3d origin = surface.points.rowwise().mean();
  double sum = 0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3d a = surface.points.col(surface.triangles(0, t)) - origin,
                          b = surface.points.col(surface.triangles(1, t)) - origin,
                          c = surface.points.col(surface.triangles(2, t)) - origin;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TriangleSurface read_stl(std::istream& stream, const std::string& name) {
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  // headers of binary files may also begin with "solid": the length decides
  if (bytes.size() >= kHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, &bytes[kHeader - sizeof count], sizeof count);
    if (bytes.size() == kHeader + kFacet * std::size_t(count)) return read_binary_stl(bytes, count);
  }
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || bytes.compare(first, 5, "solid") != 0) {
    throw ParseError(name +
                     ":1: is no STL: neither begins with 'solid' nor has the length that "
                     "its binary header declares");
  }
  TriangleSurface surface = read_ascii_stl(bytes, name);
  if (surface.triangle_count() == 0) throw ParseError(name + ":1: holds no triangles");
  return surface;
}

TriangleSurface read_obj(std::istream& stream, const std::string& name) {
  LineReader reader(stream, name, '#');
  std::vector<Eigen::Vector3d> points;
  std::vector<std::vector<long>> faces;  // indices of vertices, from 0; -1: missing
  while (reader.next()) {
    const std::string& word = reader.words()[0];
    if (word == "v") {
      points.emplace_back(reader.number(1), reader.number(2), reader.number(3));
    } else if (word == "f") {
      if (reader.size() < 4) reader.fail("a face needs at least three vertices");
      std::vector<long>& face = faces.emplace_back();
      for (int i = 1; i < reader.size(); ++i) {
        const std::string& text = reader.words()[i];
        std::istringstream one(text.substr(0, text.find('/')));
        LineReader number(one, name, '\0');
        if (!number.next() || number.size() != 1) reader.fail("'" + text + "' is no vertex");
        long n = 0;
        try {
          n = number.integer(0);
        } catch (const ParseError&) {
          reader.fail("'" + text + "' is no vertex");
        }
        if (n == 0) reader.fail("vertices are numbered from 1");
        face.push_back(n > 0 ? n - 1 : std::max(-1L, static_cast<long>(points.size()) + n));
      }
    }
  }
  if (faces.empty()) reader.fail("holds no faces");
  TriangleSurface surface;
  surface.points.resize(3, static_cast<int>(points.size()));
  for (int n = 0; n < surface.point_count(); ++n) surface.points.col(n) = points[n];
  std::vector<Eigen::Vector3i> triangles;
  std::vector<long> numbers;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto at = [&](std::size_t i) {
      return faces[f][i] < surface.point_count() ? static_cast<int>(faces[f][i]) : -1;
    };
    for (std::size_t i = 2; i < faces[f].size(); ++i) {
      triangles.emplace_back(at(0), at(i - 1), at(i));
      numbers.push_back(static_cast<long>(f) + 1);
    }
  }
  return gather(surface.points, triangles, std::move(numbers));
}

void write_stl(const TriangleSurface& surface, std::ostream& out) {
  const auto numbers = [&out](const Eigen::Vector3d& p) {
    for (int i = 0; i < 3; ++i) out << ' ' << shortest(p[i]);
    out << '\n';
  };
  out << "solid surface\n";
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3i c = surface.triangles.col(t);
    const Eigen::Vector3d a = surface.points.col(c[0]);
    const Eigen::Vector3d normal =
        (surface.points.col(c[1]) - a).cross(Eigen::Vector3d(surface.points.col(c[2])) - a);
    out << " facet normal";
    numbers(normal.norm() > 0 ? Eigen::Vector3d(normal.normalized()) : normal);
    out << "  outer loop\n";
    for (const int n : c) {
      out << "   vertex";
      numbers(surface.points.col(n));
    }
    out << "  endloop\n endfacet\n";
  }
  out << "endsolid surface\n";
}

void write_obj(const TriangleSurface& surface, std::ostream& out) {
  for (int n = 0; n < surface.point_count(); ++n) {
    out << 'v';
    for (int i = 0; i < 3; ++i) out << ' ' << shortest(surface.points(i, n));
    out << '\n';
  }
  for (int t = 0; t < surface.triangle_count(); ++t) {
    out << 'f';
    for (int i = 0; i < 3; ++i) out << ' ' << surface.triangles(i, t) + 1;
    out << '\n';
  }
}

}  // namespace palpate::mesh
