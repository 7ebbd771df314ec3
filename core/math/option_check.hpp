#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace palpate::math {

/// Throws std::invalid_argument "<name>: <value>; allowed: <allowed>" unless `is_allowed`. For the
/// checks of options and parameters.
template <class Value>
void check_option(bool is_allowed, const std::string& name, const Value& value,
                  const std::string& allowed) {
  if (is_allowed) return;
  std::ostringstream text;
  text.precision(10);
  text << name << ": " << value << "; allowed: " << allowed;
  throw std::invalid_argument(text.str());
}

inline void check_positive(double value, const std::string& name) {
  check_option(value > 0, name, value, "above 0");
}

inline void check_positive_finite(double value, const std::string& name) {
  check_option(value > 0 && std::isfinite(value), name, value, "above 0 and finite");
}

inline void check_not_negative(double value, const std::string& name) {
  check_option(value >= 0, name, value, "at least 0");
}

/// `polarity` of sensors.
inline void check_polarity(int polarity) {
  check_option(polarity == 1 || polarity == -1, "polarity", polarity, "1, -1");
}

/// Entries of a vector or matrix.
template <class Values>
void check_all_finite(const Values& values, const std::string& name) {
  check_option(values.allFinite(), name, "a number that is not finite", "finite numbers");
}

/// An axis-parallel box.
template <class Corner>
void check_box(const Corner& lower, const Corner& upper, const std::string& name) {
  for (int axis = 0; axis < 3; ++axis)
    check_option(lower[axis] < upper[axis], name + ".lower[" + std::to_string(axis) + "]",
                 lower[axis], "below upper, " + std::to_string(upper[axis]));
}

}  // namespace palpate::math
