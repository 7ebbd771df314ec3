#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace palpate::math {

/// True if the whole of `text` is a number of this type, independent of the locale; a plus sign may
/// precede it.
template <typename Number>
bool parse_number(std::string_view text, Number& number) noexcept {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end;
}

}  // namespace palpate::math
