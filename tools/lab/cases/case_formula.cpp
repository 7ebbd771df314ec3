#include "tools/lab/cases/case_formula.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace palpate::cases {
namespace {

using Eigen::Vector3d;
using Field = std::function<Vector3d(const Vector3d&)>;

/// A scalar is stored as a vector of three equal components, so that all operators act on vectors.
struct Expression {
  bool is_vector = false;
  Field at;
};

class Parser {
 public:
  Parser(const std::string& text, const std::function<double(const std::string&)>& constant)
      : text_(text), constant_(constant) {
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos) place_ = equals + 1;
  }

  Field parse() {
    const Expression whole = sum();
    const char next = peek();
    if (next != '\0' && next != ',' && next != ';' && next != '.' &&
        !std::isalpha(static_cast<unsigned char>(next)))
      fail("cannot be read");
    if (!whole.is_vector) fail("is no vector (a, b, c)");
    return whole.at;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument("'" + text_ + "' " + what + " (at character " +
                                std::to_string(place_ + 1) + ")");
  }

  char peek() {
    while (place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_])))
      ++place_;
    return place_ < text_.size() ? text_[place_] : '\0';
  }
  bool take(const std::string& token) {
    peek();
    if (text_.compare(place_, token.size(), token) != 0) return false;
    place_ += token.size();
    return true;
  }
  void require(const std::string& token) {
    if (!take(token)) fail("misses '" + token + "'");
  }

  Expression sum() {
    Expression left = product();
    while (true) {
      const bool plus = take("+");
      if (!plus && !take("-")) return left;
      const Expression right = product();
      if (left.is_vector != right.is_vector) fail("adds a vector and a number");
      const double sign = plus ? 1 : -1;
      left.at = [a = left.at, b = right.at, sign](const Vector3d& p) -> Vector3d {
        return a(p) + sign * b(p);
      };
    }
  }

  Expression product() {
    Expression left = signed_power();
    while (true) {
      const bool times = take("*");
      if (!times && !take("/")) return left;
      const Expression right = signed_power();
      if (right.is_vector && (left.is_vector || !times)) fail("multiplies or divides by a vector");
      left = {left.is_vector || right.is_vector,
              [a = left.at, b = right.at, times](const Vector3d& p) -> Vector3d {
                if (times) return a(p).cwiseProduct(b(p));
                return a(p).cwiseQuotient(b(p));
              }};
    }
  }

  Expression signed_power() {
    if (take("-")) {
      const Expression value = signed_power();
      return {value.is_vector, [a = value.at](const Vector3d& p) -> Vector3d { return -a(p); }};
    }
    const Expression base = primary();
    if (!take("^") && !take("**")) return base;
    const Expression exponent = signed_power();
    if (base.is_vector || exponent.is_vector) fail("raises a vector to a power");
    return {false, [a = base.at, b = exponent.at](const Vector3d& p) -> Vector3d {
              return Vector3d::Constant(std::pow(a(p).x(), b(p).x()));
            }};
  }

  Expression primary() {
    const char next = peek();
    if (take("(")) return bracket();
    if (std::isdigit(static_cast<unsigned char>(next)) || next == '.') return literal();
    if (std::isalpha(static_cast<unsigned char>(next))) return name();
    fail("cannot be read");
  }

  Expression bracket() {
    const Expression first = sum();
    if (take(")")) return first;
    require(",");
    const Expression second = sum();
    require(",");
    const Expression third = sum();
    require(")");
    if (first.is_vector || second.is_vector || third.is_vector) fail("nests vectors");
    return {true, [a = first.at, b = second.at, c = third.at](const Vector3d& p) {
              return Vector3d(a(p).x(), b(p).x(), c(p).x());
            }};
  }

  static Expression number(double value) {
    return {false, [value](const Vector3d&) -> Vector3d { return Vector3d::Constant(value); }};
  }

  Expression literal() {
    double value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + place_, text_.data() + text_.size(), value);
    if (error != std::errc()) fail("holds a bad number");
    place_ = static_cast<std::size_t>(end - text_.data());
    return number(value);
  }

  Expression name() {
    const std::size_t begin = place_;
    while (place_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[place_])) || text_[place_] == '_'))
      ++place_;
    const std::string word = text_.substr(begin, place_ - begin);
    for (int axis = 0; axis < 3; ++axis) {
      if (word == std::string(1, "xyz"[axis]))
        return {false,
                [axis](const Vector3d& p) -> Vector3d { return Vector3d::Constant(p[axis]); }};
    }
    static const std::map<std::string, double (*)(double)> kFunctions = {{"sqrt", std::sqrt},
                                                                         {"sin", std::sin},
                                                                         {"cos", std::cos},
                                                                         {"exp", std::exp},
                                                                         {"abs", std::abs}};
    const auto function = kFunctions.find(word);
    if (function != kFunctions.end()) {
      require("(");
      const Expression argument = sum();
      require(")");
      return {argument.is_vector,
              [f = function->second, a = argument.at](const Vector3d& p) -> Vector3d {
                return a(p).unaryExpr(f);
              }};
    }
    return number(word == "pi" ? M_PI : constant_(word));
  }

  const std::string& text_;
  const std::function<double(const std::string&)>& constant_;
  std::size_t place_ = 0;
};

}  // namespace

VectorFormula::VectorFormula(const std::string& text,
                             const std::function<double(const std::string&)>& constant)
    : field_(Parser(text, constant).parse()) {}

}  // namespace palpate::cases
