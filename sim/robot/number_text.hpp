#pragma once

#include <cstdio>
#include <string>

namespace palpate::robot {

/// Formats a number for a person to read, with four significant digits.
inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace palpate::robot
