#include <cctype>
#include <stdexcept>

#include "tools/export/plot_export.hpp"

namespace palpate::exporting {
namespace {

[[noreturn]] void fail(const std::string& text, const std::string& why) {
  throw std::runtime_error("'" + text + "': " + why +
                           "; allowed: CHANNEL.field, CHANNEL.field[2], CHANNEL.field[0][0:3], "
                           "norm(CHANNEL.field)");
}

int number(const std::string& digits, const std::string& text) {
  if (digits.empty() || digits.size() > 6 ||
      digits.find_first_not_of("0123456789") != std::string::npos)
    fail(text, "'" + digits + "' is no index");
  return std::stoi(digits);
}

}  // namespace

FieldPath parse_field_path(const std::string& text) {
  FieldPath path;
  std::string rest = text;
  if (rest.rfind("norm(", 0) == 0) {
    if (rest.back() != ')') fail(text, "the bracket of norm( is not closed");
    path.is_norm = true;
    rest = rest.substr(5, rest.size() - 6);
  }
  const std::size_t bracket = rest.find('[');
  const std::string name = rest.substr(0, bracket);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size())
    fail(text, "is no CHANNEL.field");
  path.channel = name.substr(0, dot);
  path.field = name.substr(dot + 1);
  for (std::size_t at = bracket; at != std::string::npos && at < rest.size();) {
    const std::size_t end = rest.find(']', at);
    if (rest[at] != '[' || end == std::string::npos) fail(text, "brackets do not match");
    const std::string inside = rest.substr(at + 1, end - at - 1);
    const std::size_t colon = inside.find(':');
    const int first = number(inside.substr(0, colon), text);
    const int last =
        colon == std::string::npos ? first + 1 : number(inside.substr(colon + 1), text);
    if (last <= first) fail(text, "the range [" + inside + "] is empty");
    path.ranges.emplace_back(first, last);
    at = end + 1;
  }
  return path;
}

}  // namespace palpate::exporting
