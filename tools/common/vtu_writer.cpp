#include "tools/common/vtu_writer.hpp"

#include <charconv>
#include <cstdint>
#include <stdexcept>

#include "tools/common/base64.hpp"

namespace palpate::common {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "files are written as little-endian");

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

class VtuWriter {
 public:
  VtuWriter(VtuEncoding encoding, std::ostream& out) : encoding_(encoding), out_(out) {}

  template <class Number>
  void array(const char* type, const std::string& name, Eigen::Index components,
             const std::vector<Number>& numbers) {
    const bool is_ascii = encoding_ == VtuEncoding::kAscii;
    out_ << "<DataArray type=\"" << type << "\" Name=\"" << escaped(name)
         << "\" NumberOfComponents=\"" << components << "\" format=\""
         << (is_ascii ? "ascii" : "binary") << "\">\n";
    if (is_ascii) {
      char text[32];
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        out_.write(text, std::to_chars(text, text + sizeof text, +numbers[i]).ptr - text);
        out_ << (i % 12 == 11 || i + 1 == numbers.size() ? '\n' : ' ');
      }
    } else {
      const std::uint64_t size = numbers.size() * sizeof(Number);
      std::string bytes(reinterpret_cast<const char*>(&size), sizeof size);
      bytes.append(reinterpret_cast<const char*>(numbers.data()), size);
      out_ << to_base64(bytes) << '\n';
    }
    out_ << "</DataArray>\n";
  }

  void floats(const std::string& name, const Eigen::MatrixXd& values) {
    array("Float64", name, values.rows(),
          std::vector<double>(values.data(), values.data() + values.size()));
  }

  void fields(const std::string& tag, const std::vector<GridField>& fields, Eigen::Index count) {
    out_ << "<" << tag << ">\n";
    for (const GridField& field : fields) {
      const Eigen::MatrixXd& values = field.values;
      if (values.cols() != count)
        throw std::invalid_argument("vtu: field '" + field.name + "' has " +
                                    std::to_string(values.cols()) + " entries for " +
                                    std::to_string(count));
      if (field.is_flag)
        array("UInt8", field.name, values.rows(),
              std::vector<std::uint8_t>(values.data(), values.data() + values.size()));
      else
        floats(field.name, values);
    }
    out_ << "</" << tag << ">\n";
  }

 private:
  VtuEncoding encoding_;
  std::ostream& out_;
};

}  // namespace

void write_vtu(const Grid& grid, VtuEncoding encoding, std::ostream& out) {
  VtuWriter writer(encoding, out);
  const Eigen::Index points = grid.points.cols(), count = grid.cells.cols();
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
         "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
         "<Piece NumberOfPoints=\""
      << points << "\" NumberOfCells=\"" << count << "\">\n<Points>\n";
  writer.floats("Points", grid.points);
  out << "</Points>\n<Cells>\n";
  std::vector<std::int64_t> ends;
  for (Eigen::Index c = 1; c <= count; ++c) ends.push_back(c * grid.cells.rows());
  writer.array("Int64", "connectivity", 1,
               std::vector<std::int64_t>(grid.cells.data(), grid.cells.data() + grid.cells.size()));
  writer.array("Int64", "offsets", 1, ends);
  writer.array("UInt8", "types", 1,
               std::vector<std::uint8_t>(ends.size(), static_cast<std::uint8_t>(grid.kind)));
  out << "</Cells>\n";
  writer.fields("PointData", grid.point_fields, points);
  writer.fields("CellData", grid.cell_fields, count);
  out << "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace palpate::common
