#include "tools/export/vtu_writer.hpp"

#include <cstring>
#include <stdexcept>

#include "tools/common/base64.hpp"
#include "tools/export/json_schema.hpp"
#include "tools/export/output_file.hpp"
#include "tools/log/record.hpp"

namespace palpate::exporting {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "files are written as little-endian");

/// Bytes with a size prefix, in base64.
template <class Number>
std::string encoded(const Number* numbers, std::size_t count) {
  const std::uint64_t size = count * sizeof(Number);
  std::vector<std::uint8_t> bytes(sizeof size + size);
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, numbers, size);
  return common::to_base64(bytes.data(), bytes.size());
}

std::string opening(const std::string& type, const std::string& name, Eigen::Index components) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" format=\"binary\">";
}

std::string floats(const std::string& name, const Eigen::MatrixXd& values) {
  return opening("Float64", name, values.rows()) +
         encoded(values.data(), static_cast<std::size_t>(values.size())) + "</DataArray>\n";
}

template <class Number>
std::string integers(const std::string& type, const std::string& name,
                     const std::vector<Number>& values) {
  return opening(type, name, 1) + encoded(values.data(), values.size()) + "</DataArray>\n";
}

std::string fields(const std::string& tag, const std::vector<GridField>& fields,
                   Eigen::Index count) {
  std::string text = "<" + tag + ">\n";
  for (const GridField& field : fields) {
    if (field.values.cols() != count)
      throw std::invalid_argument("vtu: field '" + field.name + "' has " +
                                  std::to_string(field.values.cols()) + " entries for " +
                                  std::to_string(count));
    text += floats(field.name, field.values);
  }
  return text + "</" + tag + ">\n";
}

std::string cells(const Grid& grid) {
  std::vector<std::int64_t> nodes(grid.cells.data(), grid.cells.data() + grid.cells.size());
  std::vector<std::int64_t> ends;
  for (Eigen::Index c = 1; c <= grid.cells.cols(); ++c) ends.push_back(c * grid.cells.rows());
  const std::vector<std::uint8_t> kinds(static_cast<std::size_t>(grid.cells.cols()),
                                        static_cast<std::uint8_t>(grid.kind));
  return "<Cells>\n" + integers("Int64", "connectivity", nodes) +
         integers("Int64", "offsets", ends) + integers("UInt8", "types", kinds) + "</Cells>\n";
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const Grid& grid) {
  const Eigen::Index points = grid.points.cols(), count = grid.cells.cols();
  const std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"" +
      std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(count) + "\">\n" +
      fields("PointData", grid.point_fields, points) + fields("CellData", grid.cell_fields, count) +
      "<Points>\n" + floats("Points", grid.points) + "</Points>\n" + cells(grid) +
      "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  OutputFile out(file);
  out.write(text);
  out.finish();
}

void write_pvd(const std::filesystem::path& file, const std::vector<SeriesEntry>& entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const SeriesEntry& entry : entries) {
    text += "<DataSet timestep=\"";
    log::append_number(entry.time, text);
    text += "\" group=\"\" part=\"0\" file=\"" +
            entry.file.lexically_relative(file.parent_path()).generic_string() + "\"/>\n";
  }
  OutputFile out(file);
  out.write(text + "</Collection>\n</VTKFile>\n");
  out.finish();
}

}  // namespace palpate::exporting
