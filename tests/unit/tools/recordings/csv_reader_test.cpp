#include "tools/recordings/csv_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"

namespace palpate::recordings {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Csv : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string path = (folder_.path() / "in.csv").string();
    std::ofstream(path) << text;
    return path;
  }

  std::vector<std::vector<std::string>> rows(const std::string& text, CsvOptions options = {}) {
    CsvReader csv(write(text), options);
    std::vector<std::vector<std::string>> all = {csv.header()};
    while (csv.next()) {
      all.emplace_back();
      for (std::size_t i = 0; i < csv.header().size(); ++i)
        all.back().push_back(csv.text(static_cast<int>(i)));
    }
    return all;
  }

  std::string complaint(const std::string& text, CsvOptions options = {}) {
    try {
      rows(text, options);
    } catch (const CsvError& error) {
      return error.what();
    }
    return "";
  }

  support::ScratchFolder folder_;
};

TEST_F(Csv, QuotedCellsMayHoldDelimitersQuotesAndLineBreaks) {
  EXPECT_THAT(rows("t,\"force, N\"\r\n1,\"a \"\"b\"\", c\"\r\n\"2\",\"two\nlines\"\r\n3,\"\"\r\n"),
              ElementsAre(ElementsAre("t", "force, N"), ElementsAre("1", "a \"b\", c"),
                          ElementsAre("2", "two\nlines"), ElementsAre("3", "")));
}

TEST_F(Csv, BlanksAroundACellDoNotCountThoseWithinQuotesDo) {
  EXPECT_THAT(
      rows(" t , name \n 1 ,  \" a \"  \n2, 5\" pipe\n"),
      ElementsAre(ElementsAre("t", "name"), ElementsAre("1", " a "), ElementsAre("2", "5\" pipe")));
}

TEST_F(Csv, TheHeaderLineDeterminesTheDelimiter) {
  for (const char delimiter : {',', ';', '\t'}) {
    std::string text = "t|a,b|c\n1|2|3\n||\n";
    if (delimiter == ',') text = "t|a;b|c\n1|2|3\n||\n";
    std::replace(text.begin(), text.end(), '|', delimiter);
    EXPECT_EQ(CsvReader(write(text)).delimiter(), delimiter);
    EXPECT_THAT(rows(text)[1], ElementsAre("1", "2", "3"));
    EXPECT_THAT(rows(text)[2], ElementsAre("", "", ""));
  }
  EXPECT_EQ(CsvReader(write("\"a;b;c\",d\n")).delimiter(), ',') << "not from within quotes";
  EXPECT_EQ(CsvReader(write("alone\n")).delimiter(), ',');
  EXPECT_EQ(CsvReader(write("\xef\xbb\xbft;a\n")).header(), (std::vector<std::string>{"t", "a"}));
}

TEST_F(Csv, TheDelimiterCanBeSet) {
  EXPECT_THAT(rows("t;f,x,y\n1;2\n", {';'}),
              ElementsAre(ElementsAre("t", "f,x,y"), ElementsAre("1", "2")));
  EXPECT_THROW(CsvReader(write("a\n"), {'|'}), std::invalid_argument);
}

TEST_F(Csv, RowsAreCountedByTheLineWhereTheyBegin) {
  CsvReader csv(write("a,b\n1,\"x\ny\nz\"\n2,3\n"));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.line(), 2);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.line(), 5);
}

TEST_F(Csv, ComplaintsNameFileLineAndWhatIsWrong) {
  EXPECT_THAT(complaint("a,b\n1,\"2\n3,4\n"),
              HasSubstr("in.csv:2: cell 2: its quote is not closed"));
  EXPECT_THAT(complaint("a,b\n1,2\n\"3\"x,4\n"),
              HasSubstr("in.csv:3: cell 1: there is text behind its closing quote"));
  EXPECT_THAT(complaint("a;b\n1;2;3\n"), HasSubstr("in.csv:2: has 3 cells, the header 2"));
  EXPECT_THAT(complaint("a,b\n1,\"" + std::string(2 << 20, 'x') + "\n\"\n"),
              HasSubstr("not closed"));
  CsvReader decimals(write("t;a\n0,5;1\n"));
  ASSERT_TRUE(decimals.next());
  try {
    decimals.number(0);
    FAIL();
  } catch (const CsvError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("in.csv:2:t: '0,5' is not a number; decimals have a point"));
  }
}

TEST_F(Csv, AllMissingColumnsAreNamedAtOnce) {
  const CsvReader csv(write("t,a,b\n"));
  EXPECT_NO_THROW(csv.require_columns({"a", "t"}));
  try {
    csv.require_columns({"a", "x", "y", "x"});
    FAIL();
  } catch (const CsvError& error) {
    EXPECT_THAT(error.what(), HasSubstr("in.csv: no columns 'x', 'y'; the columns are t, a, b"));
  }
}

}  // namespace
}  // namespace palpate::recordings
