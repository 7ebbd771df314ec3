#include "tools/export/vtu_export.hpp"

#include <array>
#include <cstdio>
#include <sstream>

#include "tools/common/table.hpp"
#include "tools/common/vtu_writer.hpp"
#include "tools/export/output_file.hpp"
#include "tools/export/predicted_contact.hpp"
#include "tools/log/record.hpp"

namespace palpate::exporting {
namespace {

using common::CellKind;
using common::Grid;

/// Positions on the grid of 3 x 3 x 3 nodes in VTK's order: corners, edges, faces, centre.
constexpr std::array<std::array<int, 3>, 27> kVtkPlaces{
    {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
     {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
     {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {0, 1, 1},
     {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}, {1, 1, 1}}};

/// A .pvd file, which ParaView opens as one series over time, with its .vtu files.
class Series {
 public:
  Series(const std::filesystem::path& folder, std::string name, std::string what)
      : folder_(folder), name_(std::move(name)), what_(std::move(what)) {}

  void add(double time, const Grid& grid) {
    const std::filesystem::path file =
        folder_ / name_ / (name_ + common::formatted("_%06zu.vtu", count_));
    std::ostringstream text;
    common::write_vtu(grid, common::VtuEncoding::kBase64, text);
    write(file, text.str());
    entries_ += "<DataSet timestep=\"";
    log::append_number(time, entries_);
    entries_ +=
        "\" group=\"\" part=\"0\" file=\"" + name_ + "/" + file.filename().string() + "\"/>\n";
    ++count_;
  }

  void finish(std::vector<Written>& written) const {
    if (count_ == 0) return;
    const std::filesystem::path file = folder_ / (name_ + ".pvd");
    write(file,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
          "byte_order=\"LittleEndian\">\n<Collection>\n" +
              entries_ + "</Collection>\n</VTKFile>\n");
    written.push_back({file, what_, static_cast<std::int64_t>(count_)});
  }

 private:
  static void write(const std::filesystem::path& file, const std::string& text) {
    OutputFile out(file);
    out.write(text);
    out.finish();
  }

  std::filesystem::path folder_;
  std::string name_, what_, entries_;
  std::size_t count_ = 0;
};

Eigen::MatrixXi vtk_cells(const log::MeshMessage& mesh) {
  if (mesh.elements.rows() != 27) return mesh.elements;
  Eigen::MatrixXi cells(27, mesh.elements.cols());
  for (int e = 0; e < cells.cols(); ++e) {
    Eigen::Matrix3Xd nodes(3, 27);
    for (int i = 0; i < 27; ++i) nodes.col(i) = mesh.nodes.col(mesh.elements(i, e));
    const Eigen::VectorXi order = vtk_order(nodes);
    for (int i = 0; i < 27; ++i) cells(i, e) = mesh.elements(order(i), e);
  }
  return cells;
}

/// Shape and derived fields.
Grid shape_grid(const ShapeEvaluator& evaluator, const Eigen::Matrix3Xd& positions,
                const ShapeFields& fields, const Eigen::MatrixXi& cells) {
  Grid grid;
  grid.points = positions;
  grid.kind = cells.rows() == 27   ? CellKind::kHexahedron27
              : cells.rows() == 10 ? CellKind::kQuadraticTetrahedron
                                   : CellKind::kTetrahedron;
  grid.cells = cells;
  Eigen::MatrixXd fixed = Eigen::MatrixXd::Zero(1, positions.cols());
  for (const int node : evaluator.mesh().constrained) fixed(0, node) = 1;
  grid.point_fields = {{"displacement", fields.displacement}, {"constrained", fixed}};
  grid.cell_fields = {{"strain", fields.strain},
                      {"equivalent_strain", fields.equivalent_strain.transpose()}};
  if (fields.von_mises.size() > 0) {
    grid.point_fields.push_back({"force", fields.force});
    grid.cell_fields.push_back({"stress", fields.stress});
    grid.cell_fields.push_back({"von_mises_stress", fields.von_mises.transpose()});
  }
  return grid;
}

/// Points with forces.
class ForceGrid {
 public:
  void add(const double* location, const double* force, const double* torque, int kind,
           int number) {
    rows_.push_back({location[0], location[1], location[2], force[0], force[1], force[2],
                     torque ? torque[0] : 0, torque ? torque[1] : 0, torque ? torque[2] : 0,
                     static_cast<double>(kind), static_cast<double>(number)});
  }
  Grid grid() const {
    const auto count = static_cast<Eigen::Index>(rows_.size());
    Eigen::MatrixXd all(11, count);
    for (Eigen::Index i = 0; i < count; ++i)
      all.col(i) = Eigen::Map<const Eigen::VectorXd>(rows_[static_cast<std::size_t>(i)].data(), 11);
    Grid grid;
    grid.points = all.topRows(3);
    grid.cells = Eigen::RowVectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1);
    grid.point_fields = {{"force", all.middleRows(3, 3)},
                         {"torque", all.middleRows(6, 3)},
                         {"kind", all.row(9)},
                         {"number", all.row(10)}};
    return grid;
  }

 private:
  std::vector<std::array<double, 11>> rows_;
};

Grid force_grid(const Instant& instant) {
  ForceGrid forces;
  if (instant.contacts) {
    for (int i = 0; i < std::min(instant.contacts->count, 8); ++i)
      forces.add(instant.contacts->location[i], instant.contacts->wrench[i],
                 instant.contacts->wrench[i] + 3, 0, i);
    for (int i = 0; i < predicted_count(*instant.contacts); ++i) {
      const PredictedContact contact = predicted_contact(*instant.contacts, i);
      forces.add(contact.place.data(), contact.force.data(), nullptr, 4, i);
    }
  }
  if (instant.estimated) {
    for (int i = 0; i < std::min(instant.estimated->grasp_count, 2); ++i)
      forces.add(instant.estimated->grasp_position[i], instant.estimated->reaction[i],
                 instant.estimated->reaction[i] + 3, 1, i);
    const double* unknown = instant.estimated->unknown_contact_force;
    if (unknown[0] != 0 || unknown[1] != 0 || unknown[2] != 0)
      forces.add(instant.estimated->unknown_contact_location, unknown, nullptr, 2, 0);
  }
  if (instant.truth_contact)
    for (int i = 0; i < std::min(instant.truth_contact->grasp_count, 2); ++i)
      forces.add(instant.truth_contact->grasp_position[i], instant.truth_contact->grasp_wrench[i],
                 instant.truth_contact->grasp_wrench[i] + 3, 3, i);
  return forces.grid();
}

/// A row of NaN for a field that a series contains, but not at this instant.
Eigen::MatrixXd or_nothing(const Eigen::MatrixXd& values, Eigen::Index rows, Eigen::Index columns) {
  if (values.size() > 0) return values;
  return Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

Eigen::VectorXi vtk_order(const Eigen::Matrix3Xd& nodes) {
  const Eigen::Matrix3Xi places = grid_places(nodes);
  Eigen::VectorXi order(27);
  for (int number = 0; number < 27; ++number) {
    const auto& place = kVtkPlaces[static_cast<std::size_t>(number)];
    order(number) = -1;
    for (int i = 0; i < 27; ++i)
      if (places(0, i) == place[0] && places(1, i) == place[1] && places(2, i) == place[2])
        order(number) = i;
    if (order(number) < 0) throw std::runtime_error("a hexahedron whose rest shape is no box");
  }
  return order;
}

std::vector<Written> export_vtu(ShapeFollower& follower, double rate,
                                const std::filesystem::path& folder) {
  Series estimate(folder, "estimate", "estimated shape"), truth(folder, "truth", "true shape"),
      forces(folder, "forces", "contacts and grasps");
  std::map<const ShapeEvaluator*, Eigen::MatrixXi> cells;
  const auto cells_of = [&cells](const ShapeEvaluator* evaluator) -> const Eigen::MatrixXi& {
    auto& found = cells[evaluator];
    if (found.size() == 0) found = vtk_cells(evaluator->mesh());
    return found;
  };
  follower.sample("writing VTU", rate, [&](const Instant& instant) {
    if (instant.estimate_mesh != nullptr) {
      const ShapeEvaluator& evaluator = *instant.estimate_mesh;
      const Eigen::Index nodes = instant.estimate.cols();
      Grid grid =
          shape_grid(evaluator, instant.estimate, evaluator.at(instant.estimate, instant.stiffness),
                     cells_of(&evaluator));
      if (follower.has_truth())
        grid.point_fields.push_back({"deviation", or_nothing(instant.deviation, 3, nodes)});
      if (follower.has_deviation())
        grid.point_fields.push_back(
            {"standard_deviation", or_nothing(instant.node_deviation.transpose(), 1, nodes)});
      estimate.add(instant.time, grid);
    }
    if (instant.truth_mesh != nullptr) {
      const ShapeEvaluator& evaluator = *instant.truth_mesh;
      truth.add(instant.time, shape_grid(evaluator, instant.truth,
                                         evaluator.at(instant.truth, instant.truth_stiffness),
                                         cells_of(&evaluator)));
    }
    if (instant.contacts || instant.estimated || instant.truth_contact)
      forces.add(instant.time, force_grid(instant));
  });
  std::vector<Written> written;
  estimate.finish(written);
  truth.finish(written);
  forces.finish(written);
  if (written.empty()) throw std::runtime_error("no shape lies in the times that were asked for");
  return written;
}

}  // namespace palpate::exporting
