#include <gtest/gtest.h>

#include "tests/support/drawn_curve.hpp"
#include "tests/unit/tools/export/small_run.hpp"
#include "tools/export/plot_export.hpp"

namespace palpate::exporting {
namespace {

TEST(FieldPath, NamesNumbersRowsRangesAndLengths) {
  const FieldPath plain = parse_field_path("FT_WRENCH.wrench");
  EXPECT_EQ(plain.channel, "FT_WRENCH");
  EXPECT_EQ(plain.field, "wrench");
  EXPECT_TRUE(plain.ranges.empty());
  const FieldPath ranged = parse_field_path("norm(A_1.b[2][0:3])");
  EXPECT_TRUE(ranged.is_norm);
  EXPECT_EQ(ranged.channel, "A_1");
  EXPECT_EQ(ranged.ranges, (std::vector<std::pair<int, int>>{{2, 3}, {0, 3}}));
  for (const char* wrong : {"", "FT_WRENCH", ".wrench", "A.", "A.b[", "A.b[x]", "A.b[3:1]",
                            "A.b[1]c", "norm(A.b", "A.b[-1]", "A.b[]"})
    EXPECT_THROW(parse_field_path(wrong), std::runtime_error) << wrong;
}

class PlotTest : public testing::Test {
 protected:
  std::string svg(const std::vector<std::string>& panels) {
    const auto file = run_.folder() / "plot.svg";
    curves_ = export_plot(source_, panels, file);
    return support::text_of(file);
  }
  std::string error(const std::string& panel) {
    try {
      export_plot(source_, {panel}, run_.folder() / "plot.svg");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  SmallRun run_;
  Source source_{quiet({run_.control(), run_.housekeeping()})};
  int curves_ = 0;
};

TEST_F(PlotTest, DrawsCurvesWithNamesAndUnits) {
  const std::string text =
      svg({"FT_WRENCH.wrench[0:3],CONTACTS.wrench[0][0:2]", "norm(FT_WRENCH.wrench[3:6])"});
  EXPECT_EQ(curves_, 6);
  for (const char* part : {"FT_WRENCH.wrench[0:3],CONTACTS.wrench[0][0:2]", "wrench[2]",
                           "wrench[0][1]", "time, s", ">N<", ">N m<", "norm(FT_WRENCH"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST_F(PlotTest, SaysWhatThereIsWhereANameIsWrong) {
  EXPECT_NE(error("NOTHING.x").find("FT_WRENCH"), std::string::npos);
  EXPECT_NE(error("FT_WRENCH.force").find("wrench"), std::string::npos);
  EXPECT_NE(error("FT_WRENCH.wrench[6]").find("0 to 5"), std::string::npos);
  EXPECT_NE(error("CONTACTS.wrench[1]").find("0 to 0"), std::string::npos);
  EXPECT_NE(error("SHAPE.xyz").find("at most 64"), std::string::npos);
  EXPECT_THROW(export_plot(source_, {"FT_WRENCH.wrench"}, run_.folder() / "plot.pdf"),
               std::runtime_error);
}

TEST(Plot, WhereNothingCameThereIsNoLine) {
  const support::ScratchFolder scratch;
  const auto strokes = [&scratch](int missing) {
    const auto log = scratch.path() / "log", file = scratch.path() / "plot.svg";
    {
      LogWriter writer(log);
      for (int i = 0; i < 1000; ++i)
        if (i < 500 || i >= 500 + missing) writer.write("FT_WRENCH", 1000 * i, ft_wrench_t{});
    }
    Source source(quiet({log}));
    export_plot(source, {"FT_WRENCH.wrench[0]"}, file);
    return support::strokes_of(support::first_curve(support::text_of(file)));
  };
  EXPECT_EQ(strokes(100), strokes(0) + 1);
  EXPECT_EQ(strokes(5), strokes(0));
  EXPECT_EQ(strokes(0), 1);
}

// A single message among 100,000 that stands out.
TEST(Plot, PeaksAreKept) {
  const support::ScratchFolder scratch;
  const auto log = scratch.path() / "log", file = scratch.path() / "plot.svg";
  {
    LogWriter writer(log);
    ft_wrench_t wrench{};
    for (int i = 0; i < 100'000; ++i) {
      wrench.wrench[0] = i == 54'321 ? 1000 : 0;
      writer.write("FT_WRENCH", 1000 * i, wrench);
    }
  }
  Source source(quiet({log}));
  EXPECT_EQ(export_plot(source, {"FT_WRENCH.wrench[0]"}, file), 1);
  const std::string svg = support::text_of(file);
  EXPECT_NE(svg.find("1000</"), std::string::npos) << "the axis reaches up to the peak";
  EXPECT_LT(svg.size(), 200'000u);
}

}  // namespace
}  // namespace palpate::exporting
