#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/mesh/gmsh_content.hpp"
#include "core/mesh/mesh_writer.hpp"

namespace palpate::mesh {
namespace {

using Groups = std::vector<int>;  // physical numbers, ascending

// Positions of kGmshEdges in an element's own order of midside nodes (kTetrahedronEdges).
constexpr int kMiddles[6] = {4, 5, 6, 7, 9, 8};

/// Elements of one dimension with the same groups: an entity of version 4.1.
struct Block {
  int dimension = 3;
  int entity = 1;
  Groups groups;
  std::vector<std::vector<int>> elements;  // nodes, 0-based, in Gmsh's order
};

class GmshWriter {
 public:
  GmshWriter(const MeshWithGroups& mesh, const GmshFormat& format, std::ostream& out)
      : mesh_(mesh),
        format_(format),
        out_(out),
        elements_(checked(mesh, format.order)),
        binary_(format.encoding == Encoding::kBinary) {
    gather();
  }

  void write() {
    const bool old = format_.version == GmshVersion::k2_2;
    out_ << "$MeshFormat\n" << (old ? "2.2 " : "4.1 ") << (binary_ ? 1 : 0) << " 8\n";
    if (binary_) {
      put<std::int32_t>(1);
      out_ << '\n';
    }
    out_ << "$EndMeshFormat\n";
    write_names();
    if (!old) write_entities();
    out_ << "$Nodes\n";
    old ? write_nodes_2() : write_nodes_4();
    out_ << (binary_ ? "\n" : "") << "$EndNodes\n$Elements\n";
    old ? write_elements_2() : write_elements_4();
    out_ << (binary_ ? "\n" : "") << "$EndElements\n";
  }

 private:
  static ElementMesh checked(const MeshWithGroups& mesh, ElementOrder order) {
    const Eigen::Matrix4Xi& t = mesh.mesh.tetrahedra;
    if (t.size() > 0 && (t.minCoeff() < 0 || t.maxCoeff() >= mesh.mesh.node_count())) {
      throw std::invalid_argument("a tetrahedron names a node that is not there");
    }
    return element_mesh(mesh, order);
  }

  /// Creates blocks by the groups of their elements; surface triangles first.
  void gather() {
    std::map<std::vector<int>, Groups> triangles;
    std::vector<Groups> of_tetrahedron(mesh_.mesh.tetrahedron_count());
    int number = 0;
    for (const auto& [name, group] : mesh_.groups) {
      ++number;
      for (int t = 0; t < group.triangles.cols(); ++t) {
        const Eigen::Vector3i corners = group.triangles.col(t);
        triangles[{corners[0], corners[1], corners[2]}].push_back(number);
      }
      for (const int t : group.tetrahedra) of_tetrahedron.at(t).push_back(number);
    }
    std::map<Groups, Block> surfaces, solids;
    for (const auto& [corners, groups] : triangles) {
      surfaces[groups].elements.push_back(with_middles(corners));
    }
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      std::vector<int> nodes;
      for (int i = 0; i < 4; ++i) nodes.push_back(elements_.elements(i, t));
      for (const int middle : kMiddles) {
        if (format_.order == ElementOrder::kQuadratic)
          nodes.push_back(elements_.elements(middle, t));
      }
      solids[of_tetrahedron[t]].elements.push_back(std::move(nodes));
    }
    for (auto* blocks : {&surfaces, &solids}) {
      int entity = 0;
      for (auto& [groups, block] : *blocks) {
        block.dimension = blocks == &surfaces ? 2 : 3;
        block.entity = ++entity;
        block.groups = groups;
        element_count_ += block.elements.size();
        blocks_.push_back(std::move(block));
      }
    }
  }

  /// Corners of a triangle and, in a quadratic mesh, its midside nodes on edges 01, 12, 20.
  std::vector<int> with_middles(std::vector<int> corners) {
    if (format_.order == ElementOrder::kLinear) return corners;
    if (middles_.empty()) {
      for (int t = 0; t < elements_.element_count(); ++t) {
        for (int e = 0; e < 6; ++e) {
          middles_[std::minmax(elements_.elements(kTetrahedronEdges[e][0], t),
                               elements_.elements(kTetrahedronEdges[e][1], t))] =
              elements_.elements(4 + e, t);
        }
      }
    }
    for (int i = 0; i < 3; ++i) {
      const auto found = middles_.find(std::minmax(corners[i], corners[(i + 1) % 3]));
      if (found == middles_.end()) {
        throw std::invalid_argument("a triangle of a group has an edge of no tetrahedron");
      }
      corners.push_back(found->second);
    }
    return corners;
  }

  long type_of(const Block& block) const {
    if (format_.order == ElementOrder::kQuadratic) return block.dimension == 2 ? 9 : 11;
    return block.dimension == 2 ? 2 : 4;
  }

  template <typename Number>
  void put(Number value) {
    out_.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
  /// Writes a number and a separator as text; the bytes of the type otherwise.
  template <typename Number>
  void item(Number value, char end = ' ') {
    binary_ ? put(value) : static_cast<void>(out_ << value << end);
  }
  void point(const Eigen::Vector3d& p, char end) {
    for (int i = 0; i < 3; ++i) {
      binary_ ? put(p[i]) : static_cast<void>(out_ << shortest(p[i]) << (i < 2 ? ' ' : end));
    }
  }

  void write_names() {
    if (mesh_.groups.empty()) return;
    // a surface and a solid may have the same name
    std::vector<std::string> lines;
    int number = 0;
    for (const auto& [name, group] : mesh_.groups) {
      ++number;
      const std::string rest = " " + std::to_string(number) + " \"" + name + "\"\n";
      if (group.triangles.cols() > 0) lines.push_back("2" + rest);
      if (!group.tetrahedra.empty()) lines.push_back("3" + rest);
    }
    out_ << "$PhysicalNames\n" << lines.size() << '\n';
    for (const std::string& line : lines) out_ << line;
    out_ << "$EndPhysicalNames\n";
  }

  void write_entities() {
    using Size = std::uint64_t;
    out_ << "$Entities\n";
    const auto count = [this](int dimension) {
      return static_cast<Size>(std::count_if(blocks_.begin(), blocks_.end(), [&](const Block& b) {
        return b.dimension == dimension;
      }));
    };
    item<Size>(0), item<Size>(0), item<Size>(count(2)), item<Size>(count(3), '\n');
    const Eigen::Vector3d lower = elements_.nodes.rowwise().minCoeff(),
                          upper = elements_.nodes.rowwise().maxCoeff();
    for (const Block& block : blocks_) {
      item<std::int32_t>(block.entity);
      point(lower, ' '), point(upper, ' ');
      item<Size>(block.groups.size());
      for (const int group : block.groups) item<std::int32_t>(group);
      item<Size>(0, '\n');
    }
    out_ << (binary_ ? "\n" : "") << "$EndEntities\n";
  }

  void write_nodes_2() {
    out_ << elements_.node_count() << '\n';
    for (int n = 0; n < elements_.node_count(); ++n) {
      item<std::int32_t>(n + 1);
      point(elements_.nodes.col(n), '\n');
    }
  }

  void write_nodes_4() {
    using Size = std::uint64_t;
    const auto count = static_cast<Size>(elements_.node_count());
    item<Size>(1), item<Size>(count), item<Size>(1), item<Size>(count, '\n');
    item<std::int32_t>(3), item<std::int32_t>(1), item<std::int32_t>(0), item<Size>(count, '\n');
    for (Size n = 1; n <= count; ++n) item<Size>(n, '\n');
    for (int n = 0; n < elements_.node_count(); ++n) point(elements_.nodes.col(n), '\n');
  }

  void write_elements_2() {
    out_ << element_count_ << '\n';
    std::int32_t number = 0;
    for (const Block& block : blocks_) {
      const auto type = static_cast<std::int32_t>(type_of(block));
      if (binary_) {
        put(type);
        put(static_cast<std::int32_t>(block.elements.size()));
        put<std::int32_t>(2);
      }
      for (const std::vector<int>& nodes : block.elements) {
        item(++number);
        if (!binary_) out_ << type << " 2 ";
        item<std::int32_t>(block.groups.empty() ? 0 : block.groups.front());
        item<std::int32_t>(block.entity);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          item<std::int32_t>(nodes[i] + 1, i + 1 == nodes.size() ? '\n' : ' ');
        }
      }
    }
  }

  void write_elements_4() {
    using Size = std::uint64_t;
    item<Size>(blocks_.size()), item<Size>(element_count_), item<Size>(1);
    item<Size>(element_count_, '\n');
    Size number = 0;
    for (const Block& block : blocks_) {
      item<std::int32_t>(block.dimension), item<std::int32_t>(block.entity);
      item(static_cast<std::int32_t>(type_of(block)));
      item<Size>(block.elements.size(), '\n');
      for (const std::vector<int>& nodes : block.elements) {
        item<Size>(++number);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          item<Size>(nodes[i] + 1, i + 1 == nodes.size() ? '\n' : ' ');
        }
      }
    }
  }

  const MeshWithGroups& mesh_;
  const GmshFormat& format_;
  std::ostream& out_;
  ElementMesh elements_;
  bool binary_;
  std::vector<Block> blocks_;
  std::size_t element_count_ = 0;
  std::map<std::pair<int, int>, int> middles_;  // midside node of an edge
};

}  // namespace

void write_gmsh(const MeshWithGroups& mesh, const GmshFormat& format, std::ostream& out) {
  GmshWriter(mesh, format, out).write();
}

}  // namespace palpate::mesh
