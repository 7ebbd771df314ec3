#pragma once

#include <cstdio>
#include <string>

namespace palpate::robot {

/// A number for people to read, of four digits that count.
inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace palpate::robot
