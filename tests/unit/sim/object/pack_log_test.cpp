#include "sim/object/hexahedron_pack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::object {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

TEST(PackLog, LogarithmAndReciprocalAreRightToTwoUnits) {
  double worst_log = 0, worst_inverse = 0;
  const auto check = [&](double x) {
    // A lane must be independent of its neighbours.
    const LogAndInverse found = log_and_inverse(math::Pack4d{3e5, x, 1e-3 * x, 1});
    const long double exact = std::log(static_cast<long double>(x));
    const auto error = static_cast<double>(std::abs(found.log[1] - exact) / std::abs(exact));
    if (x != 1) worst_log = std::max(worst_log, error);
    worst_inverse = std::max(worst_inverse, std::abs(found.inverse[1] * x - 1));
    EXPECT_EQ(found.log[3], 0);
    EXPECT_EQ(found.inverse[3], 1);
  };
  for (int i = -40000; i <= 40000; ++i) check(std::exp2(1e-3 * i));
  for (int i = -1000; i <= 1000; ++i) check(1 + 1e-9 * i);
  for (const double x : {std::sqrt(0.5), std::sqrt(2.0), 0.2, 1e-300, 1e300}) check(x);
  EXPECT_LT(worst_log, 2 * kUnit);
  EXPECT_LT(worst_inverse, 2 * kUnit);
}

}  // namespace
}  // namespace palpate::object
