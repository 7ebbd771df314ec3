#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/unit/tools/fit/fit_folder.hpp"
#include "tools/fit/recording.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::fit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::vector<WantedColumn> kForceAndLength = {{"force", Dimension::kForce, "of the ball"},
                                                   {"displacement", Dimension::kLength, "of it"},
                                                   {"width", Dimension::kLength, "across", false}};
constexpr char kColumns[] =
    "columns: {force: {name: F, unit: mN, sign: -1}, displacement: {name: u, unit: mm}}";

class RecordingTest : public testing::Test {
 protected:
  RecordingTest() { folder_.write("a.csv", "u,F,probe\n1,-10,1\n2,-20,1\n\n3,-30,2\n4,-40,2\n"); }

  Recording read(const std::string& yaml) const {
    return {config::Node::from_text(yaml, "plan"), folder_.path(), kForceAndLength};
  }

  std::string complaint(const std::string& yaml) const {
    try {
      read(yaml);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  FitFolder folder_;
};

TEST_F(RecordingTest, ColumnsAreInSiUnits) {
  const Recording r = read(std::string("file: a.csv\n") + kColumns);
  EXPECT_EQ(r.name(), "a");
  ASSERT_EQ(r.rows(), 4);
  EXPECT_DOUBLE_EQ(r.column("force")[1], 0.02);
  EXPECT_DOUBLE_EQ(r.column("displacement")[3], 0.004);
  EXPECT_FALSE(r.has("width"));
}

TEST_F(RecordingTest, RowsAreChosenByAColumnAndByPlace) {
  const Recording one = read(std::string("file: a.csv\nwhere: {probe: 2}\n") + kColumns);
  ASSERT_EQ(one.rows(), 2);
  EXPECT_DOUBLE_EQ(one.column("displacement")[0], 0.003);
  const Recording other =
      read(std::string("file: a.csv\nrows: {first: 1, last: 3, step: 2}\n") + kColumns);
  ASSERT_EQ(other.rows(), 2);
  EXPECT_DOUBLE_EQ(other.column("displacement")[1], 0.004);
  EXPECT_EQ(distinct_values(folder_.path() / "a.csv", "probe"), (std::vector<double>{1, 2}));
}

TEST_F(RecordingTest, ARowIsNamedByItsLineOfTheFile) {
  const Recording r = read(std::string("file: a.csv\nname: b\n") + kColumns);
  try {
    r.fail(2, "is odd");
    FAIL();
  } catch (const recordings::CsvError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.csv:5: is odd"));
  }
}

TEST_F(RecordingTest, AUnitThatCannotBeNamesKeyAndAllowedOnes) {
  EXPECT_THAT(
      complaint("file: a.csv\ncolumns: {force: {name: F, unit: mm}, displacement: {name: u}}"),
      AllOf(HasSubstr("plan:2"), HasSubstr("columns.force.unit"), HasSubstr("'mm'"),
            HasSubstr("'mN'")));
}

TEST_F(RecordingTest, AColumnThatIsMissingNamesThoseThatExist) {
  EXPECT_THAT(complaint("file: a.csv\ncolumns: {force: {name: G}, displacement: {name: u}}"),
              AllOf(HasSubstr("a.csv"), HasSubstr("'G'"), HasSubstr("'probe'")));
  EXPECT_THAT(complaint("file: a.csv\ncolumns: {force: {name: F}}"),
              AllOf(HasSubstr("columns.displacement"), HasSubstr("is absent")));
  EXPECT_THAT(complaint(std::string("file: b.csv\n") + kColumns), HasSubstr("b.csv"));
}

TEST_F(RecordingTest, ACellThatIsNoNumberNamesRowAndRemedy) {
  for (const std::string cell : {"nan", "inf", "", "two"}) {
    folder_.write("bad_" + cell + ".csv", "u,F\n1,2\n2," + cell + "\n");
    EXPECT_THAT(complaint("file: bad_" + cell + ".csv\n" + kColumns),
                AllOf(HasSubstr(".csv:3:F"), HasSubstr("not a finite number"), HasSubstr("rows")));
  }
}

TEST_F(RecordingTest, AFileThatChangesIsReadAgain) {
  read(std::string("file: a.csv\n") + kColumns);
  folder_.write("a.csv", "u,F\n7,1\n");
  std::filesystem::last_write_time(
      folder_.path() / "a.csv",
      std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  EXPECT_EQ(read(std::string("file: a.csv\n") + kColumns).rows(), 1);
}

TEST_F(RecordingTest, NumbersMayHaveUnits) {
  const config::Node node = config::Node::from_text("a: 10.5 mm\nb: 0.2\nc: 3 N\nd: x mm", "plan");
  EXPECT_DOUBLE_EQ(read_quantity(node, "a", Dimension::kLength, {0, 1}), 0.0105);
  EXPECT_DOUBLE_EQ(read_quantity(node, "b", Dimension::kLength, {0, 1}), 0.2);
  EXPECT_DOUBLE_EQ(read_quantity(node, "e", Dimension::kLength, {0, 1}, 7), 7);
  for (const char* key : {"c", "d"})
    EXPECT_THROW(read_quantity(node, key, Dimension::kLength, {0, 1}), config::Error);
  EXPECT_THROW(read_quantity(node, "a", Dimension::kLength, {0, 0.01}), config::Error);
}

TEST_F(RecordingTest, SamplesAreHeldOutByWhatTheyAre) {
  const auto held = [&](const std::string& how) {
    const std::string yaml = std::string("file: a.csv\nheld_out: ") + how + "\n" + kColumns;
    return held_out_samples(config::Node::from_text(yaml, "plan"), read(yaml), {});
  };
  EXPECT_TRUE(held("false").empty());
  EXPECT_EQ(held("true"), std::vector<bool>(4, true));
  EXPECT_EQ(held("{quantity: displacement, from: 0.003}"),
            (std::vector<bool>{false, false, true, true}));
  EXPECT_EQ(held("{quantity: sample, to: 0}"), (std::vector<bool>{true, false, false, false}));
  EXPECT_THROW(held("{quantity: colour, to: 0}"), config::Error);
}

TEST(Units, EveryDimensionKnowsItsSiUnit) {
  for (int k = 0; k <= static_cast<int>(Dimension::kRatio); ++k) {
    const auto dimension = static_cast<Dimension>(k);
    EXPECT_EQ(si_factor(dimension, units_of(dimension).front()), 1) << name_of(dimension);
    EXPECT_EQ(si_factor(dimension, "furlong"), 0);
  }
  EXPECT_DOUBLE_EQ(si_factor(Dimension::kStress, "kPa"), 1e3);
  EXPECT_DOUBLE_EQ(si_factor(Dimension::kAngle, "deg") * 180, 3.14159265358979323846);
}

}  // namespace
}  // namespace palpate::fit
