#pragma once

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/surface.hpp"
#include "tools/lab/cases/case_file.hpp"

namespace palpate::cases {

/// A bar 0.2 x 0.04 x 0.04 m of E = 1e5 Pa without lateral contraction, pulled by 2 N at x = 0.2:
/// it stretches uniformly, by 1.25 %.
inline const char* const kPulledBar = R"(name: pulled_bar
geometry:
  type: union_of_boxes
  boxes:
  - {min: [0, 0, 0], max: [0.2, 0.04, 0.04]}
material: {E: 100000.0, nu: 0.0, rho: 0.0, law: whatever}
gravity: [0.0, 0.0, -9.81]
fixed:
  group: fixed
  kind: all nodes
  box: {min: [0, 0, 0], max: [0, 0.04, 0.04]}
loads:
- group: load
  box: {min: [0.2, 0, 0], max: [0.2, 0.04, 0.04]}
  follower: false
  type: total_force_uniform_traction
  total_force: [2.0, 0.0, 0.0]
files: {mesh_coarse: mesh_coarse.msh}
)";
inline constexpr double kPulledStretch = 0.0125;

/// Tetrahedra of a box with the triangles of two faces across x as groups.
inline mesh::MeshWithGroups bar_mesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                                     const std::string& far_group = "load") {
  mesh::MeshWithGroups result;
  result.mesh = mesh::make_box(size, cells);
  const Eigen::Matrix3Xi surface =
      mesh::extract_surface(mesh::make_element_mesh(result.mesh, mesh::ElementOrder::kLinear))
          .triangles;
  for (int t = 0; t < surface.cols(); ++t) {
    const auto lies_at = [&](double x) {
      for (int i = 0; i < 3; ++i)
        if (std::abs(result.mesh.nodes(0, surface(i, t)) - x) > 1e-12) return false;
      return true;
    };
    if (!lies_at(0) && !lies_at(size.x())) continue;
    Eigen::Matrix3Xi& group = result.groups[lies_at(0) ? "fixed" : far_group].triangles;
    group.conservativeResize(3, group.cols() + 1);
    group.rightCols<1>() = surface.col(t);
  }
  return result;
}

/// A temporary case folder.
class CaseFolder {
 public:
  CaseFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-case-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~CaseFolder() { std::filesystem::remove_all(path_); }
  CaseFolder(const CaseFolder&) = delete;
  CaseFolder& operator=(const CaseFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
  }

  /// Probes on a line through the bar, with the displacement given by `u`.
  void write_probes(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& u) const {
    std::ofstream out(path_ / "probes.csv");
    out.precision(17);
    out << "id,x,y,z,ux,uy,uz\n";
    for (int i = 0; i <= 10; ++i) {
      const Eigen::Vector3d p(0.02 * i, 0.004 * i, 0.04 - 0.003 * i), d = u(p);
      out << i << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << d.x() << ',' << d.y()
          << ',' << d.z() << '\n';
    }
  }

  /// Gmsh 2.2 with the groups' triangles.
  void write_mesh(const std::string& name, const mesh::MeshWithGroups& m) const {
    std::ofstream out(path_ / name);
    out.precision(17);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"
        << m.groups.size() + 1 << "\n3 1 \"body\"\n";
    int number = 2, elements = m.mesh.tetrahedron_count();
    for (const auto& [group, members] : m.groups) {
      out << "2 " << number++ << " \"" << group << "\"\n";
      elements += static_cast<int>(members.triangles.cols());
    }
    out << "$EndPhysicalNames\n$Nodes\n" << m.mesh.node_count() << '\n';
    for (int n = 0; n < m.mesh.node_count(); ++n)
      out << n + 1 << ' ' << m.mesh.nodes.col(n).transpose() << '\n';
    out << "$EndNodes\n$Elements\n" << elements << '\n';
    int id = 1;
    number = 2;
    for (const auto& [group, members] : m.groups) {
      for (int t = 0; t < members.triangles.cols(); ++t)
        out << id++ << " 2 2 " << number << ' ' << number << ' '
            << (members.triangles.col(t).array() + 1).transpose() << '\n';
      ++number;
    }
    for (int t = 0; t < m.mesh.tetrahedron_count(); ++t)
      out << id++ << " 4 2 1 1 " << (m.mesh.tetrahedra.col(t).array() + 1).transpose() << '\n';
    out << "$EndElements\n";
  }

 private:
  std::filesystem::path path_;
};

/// The pulled bar, with probes of the exact solution.
inline void write_pulled_bar(const CaseFolder& folder, const std::string& yaml = kPulledBar) {
  folder.write("case.yaml", yaml);
  folder.write_mesh("mesh_coarse.msh", bar_mesh({0.2, 0.04, 0.04}, {5, 1, 1}));
  folder.write_probes(
      [](const Eigen::Vector3d& p) { return Eigen::Vector3d(kPulledStretch * p.x(), 0, 0); });
}

}  // namespace palpate::cases
