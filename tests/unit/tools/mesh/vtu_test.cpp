#include "tools/mesh/mesh_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/round_mesh.hpp"

namespace palpate::mesh_tool {
namespace {

using mesh::ElementOrder;
using mesh::MeshWithGroups;
using ::testing::HasSubstr;

MeshWithGroups read(const std::string& text, mesh::OnFault on_fault = mesh::OnFault::kThrow) {
  std::istringstream stream(text);
  return read_vtu(stream, "a.vtu", on_fault);
}

std::string written(const MeshWithGroups& mesh, ElementOrder order, VtuEncoding encoding) {
  std::ostringstream out;
  write_vtu(mesh, order, encoding, out);
  return out.str();
}

TEST(Vtu, MeshesOfEitherOrderComeBackToTheBitFromEitherEncoding) {
  const MeshWithGroups mesh =
      mesh::make_ellipsoid({0.05, 0.03, 0.02}, 3, mesh::RoundSides::kCurved);
  for (const auto order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    for (const auto encoding : {VtuEncoding::kAscii, VtuEncoding::kBase64}) {
      const MeshWithGroups back = read(written(mesh, order, encoding));
      EXPECT_EQ(hash(back.mesh), hash(mesh.mesh));
      EXPECT_EQ(back.groups.at("body").tetrahedra, mesh.groups.at("body").tetrahedra);
      EXPECT_EQ(back.groups.at("body").nodes, mesh.groups.at("body").nodes);
      if (order == ElementOrder::kLinear) continue;
      EXPECT_EQ(mesh::element_mesh(back, order).nodes, mesh::element_mesh(mesh, order).nodes);
    }
  }
}

TEST(Vtu, ErrorsNameTheFileAndWhatIsWrong) {
  const std::string good = written(mesh::make_ellipsoid({1, 1, 1}, 1, mesh::RoundSides::kFull),
                                   ElementOrder::kLinear, VtuEncoding::kAscii);
  const auto error_of = [&good](const std::string& from, const std::string& to) -> std::string {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      read(text);
    } catch (const mesh::ParseError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of("UnstructuredGrid\"", "PolyData\""), HasSubstr("a.vtu: is no Unstructured"));
  EXPECT_THAT(error_of("LittleEndian", "BigEndian"), HasSubstr("byte order"));
  EXPECT_THAT(error_of("<Points>", "<Pints>"), HasSubstr("a.vtu: there is no Points"));
  EXPECT_THAT(error_of("<Cells>", "<Cells"), HasSubstr("a.vtu:"));
  EXPECT_THAT(error_of("offsets", "ends"), HasSubstr("there is no DataArray offsets"));
  EXPECT_THAT(error_of("format=\"ascii\"", "format=\"hex\""), HasSubstr("format 'hex'"));
  const std::size_t key = good.find("connectivity"), line = good.find('\n', key);
  const std::string head = good.substr(key, line - key);
  const std::string first = good.substr(line, good.find(' ', line + 1) - line);
  EXPECT_THAT(error_of(head + first + " ", head + "\n99 "),
              HasSubstr("cell 0 names a node that is not there"));
  EXPECT_THAT(error_of("10 10", "10 12"), HasSubstr("too few nodes"));
}

TEST(Vtu, CutAnywhereItIsRefused) {
  const MeshWithGroups mesh = mesh::make_ellipsoid({1, 1, 1}, 1, mesh::RoundSides::kFull);
  for (const auto encoding : {VtuEncoding::kAscii, VtuEncoding::kBase64}) {
    const std::string whole = written(mesh, ElementOrder::kLinear, encoding);
    for (std::size_t length = 0; length + 12 < whole.size(); length += 11)
      EXPECT_THROW(read(whole.substr(0, length)), mesh::ParseError) << length;
  }
}

}  // namespace
}  // namespace palpate::mesh_tool
