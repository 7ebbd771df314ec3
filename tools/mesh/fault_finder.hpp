#pragma once

#include <functional>

#include "core/mesh/connectivity.hpp"
#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {

/// Collects faults of cells (tetrahedra or triangles) over points, with their numbers in the file
/// and what there is to be shown of them. The mesh must outlive the finder.
class FaultFinder {
 public:
  using Number = std::function<long(int index)>;
  FaultFinder(const Eigen::Matrix3Xd& points, const Eigen::Ref<const Eigen::MatrixXi>& cells,
              Number cell_number, Number point_number)
      : points_(points),
        cells_(cells),
        cell_number_(std::move(cell_number)),
        point_number_(std::move(point_number)) {}

 protected:
  Fault& start(const std::string& kind, const std::string& what,
               Severity severity = Severity::kError);
  /// Nothing if the list is empty.
  void add_cells(const std::string& kind, const std::string& what, const std::vector<int>& cells,
                 Severity severity = Severity::kError);
  void add_points(const std::string& kind, const std::string& what, const std::vector<int>& points);
  void show_edges(const std::vector<mesh::Edge>& edges, Fault& fault) const;
  /// What valid corners leave of a cell: a tetrahedron, a triangle or a line, and its centre.
  void show(int cell, Fault& fault) const;
  /// Cells that name one of these points, given in ascending order.
  std::vector<int> cells_at(const std::vector<int>& points) const;
  /// Warns if the body is much larger or smaller than anything that a hand can hold.
  void add_size();

  std::vector<Fault> faults_;

 private:
  const Eigen::Matrix3Xd& points_;
  Eigen::Ref<const Eigen::MatrixXi> cells_;
  Number cell_number_, point_number_;
};

}  // namespace palpate::mesh_tool
