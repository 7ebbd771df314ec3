#include "tools/lab/cases/case_formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>

namespace palpate::cases {
namespace {

using Eigen::Vector3d;

double constant(const std::string& name) {
  static const std::map<std::string, double> kConstants{{"T", 0.1}, {"a", 0.05}};
  const auto found = kConstants.find(name);
  if (found == kConstants.end()) throw std::invalid_argument("no " + name);
  return found->second;
}

Vector3d at(const std::string& text, const Vector3d& p) { return VectorFormula(text, constant)(p); }

TEST(VectorFormula, ReadsATractionFromItsDescription) {
  const VectorFormula traction(
      "dead traction t(y,z) = (6*T/a^4) * (0, -(z-a/2), (y-a/2)) Pa on the rest face, T=0.1 N m, "
      "a=0.05 m; force directions stay fixed in space",
      constant);
  const Vector3d p(0.2, 0.013, 0.041);
  const double factor = 6 * 0.1 / std::pow(0.05, 4);
  EXPECT_LT((traction(p) - factor * Vector3d(0, -(0.041 - 0.025), 0.013 - 0.025)).norm(), 1e-9);
}

TEST(VectorFormula, KnowsPrecedenceFunctionsAndPowers) {
  const Vector3d p(2, 3, 5);
  EXPECT_EQ(at("(x, y, z)", p), p);
  EXPECT_EQ(at("-2*(x, y, z)/4 + (1, 0, 0)", p), Vector3d(0, -1.5, -2.5));
  EXPECT_EQ(at("t = (x + y*z, -x^2, 2**-1) - (0, 0, z - y - x)", p), Vector3d(17, -4, 0.5));
  EXPECT_LT(
      (at("(sqrt(x*8), sin(pi/6), abs(x-y)) * (cos(0) + exp(0))", p) - Vector3d(8, 1, 2)).norm(),
      1e-15);
  EXPECT_EQ(at("1e2*(x/y/z, 2^3^0, .5)", {6, 3, 2}), Vector3d(100, 200, 50));
}

class BadFormula : public testing::TestWithParam<const char*> {};

TEST_P(BadFormula, IsRefused) {
  EXPECT_THROW(VectorFormula(GetParam(), constant), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Texts, BadFormula,
                         testing::Values("", "t = ", "x + y", "6*T", "(x, y)", "(x, y, z",
                                         "(x, y, w)", "(x, y, z) (x, y, z)", "(x, y, z)*(x, y, z)",
                                         "1/(x, y, z)", "(x, y, z)^2", "1 + (x, y, z)",
                                         "((x, y, z), 1, 2)", "sqrt x*(1, 0, 0)", "(x, y, 2 T)",
                                         "(x, y, z) + ", "2 (x, y, z)"));

}  // namespace
}  // namespace palpate::cases
