#include "tools/common/table.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace palpate::common {
namespace {

TEST(Table, ColumnsAreAligned) {
  Table table({"run", "mm"});
  table.section("a");
  table.add({"long name", "1.00"});
  table.add({"x", "10.00"});
  std::ostringstream out;
  table.print(out);
  EXPECT_EQ(out.str(),
            "run           mm\n"
            "----------------\n"
            "-- a -----------\n"
            "long name   1.00\n"
            "x          10.00\n");
}

TEST(Table, NumbersAreRounded) { EXPECT_EQ(number(1.2345, 2), "1.23"); }

}  // namespace
}  // namespace palpate::common
