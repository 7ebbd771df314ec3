#pragma once

#include <sstream>
#include <stdexcept>

namespace palpate::math {

/// Throws std::invalid_argument "<name>: <value>; allowed: <allowed>" unless `is_allowed`. For the
/// checks of options: `if (!...) throw` without the value leaves the caller to find it.
template <class Value>
void check_option(bool is_allowed, const char* name, const Value& value, const char* allowed) {
  if (is_allowed) return;
  std::ostringstream text;
  text.precision(10);
  text << name << ": " << value << "; allowed: " << allowed;
  throw std::invalid_argument(text.str());
}

}  // namespace palpate::math
