#include "tools/lab/runs/absolute_override.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::runs {
namespace {

std::string text_of(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::string scaled_list(std::vector<double> values, double factor) {
  const bool whole = std::all_of(values.begin(), values.end(),
                                 [](double value) { return value == std::floor(value); });
  std::string text;
  for (const double value : values) {
    const double scaled = whole ? std::max(1.0, std::round(factor * value)) : factor * value;
    text += (text.empty() ? "" : ", ") + text_of(scaled);
  }
  return "[" + text + "]";
}

}  // namespace

std::string absolute_override(const std::string& item, const std::filesystem::path& file) {
  const std::size_t equals = item.find('=');
  const char sign = equals == 0 || equals == std::string::npos ? ' ' : item[equals - 1];
  if (sign != '*' && sign != '+') return item;
  const std::string path = item.substr(0, equals - 1);
  const double change =
      config::Node::from_text("change: " + item.substr(equals + 1), item).number("change", {});

  config::Node node = config::Node::load_file(file.string());
  std::istringstream keys(path);
  std::string key, next;
  std::getline(keys, key, '.');
  while (std::getline(keys, next, '.')) {
    node = node.child(key);
    key = next;
  }
  if (sign == '+') return path + "=" + text_of(node.number(key, {}) + change);
  // A number is the common case; a value that is neither is reported as a list.
  try {
    return path + "=" + text_of(node.number(key, {}) * change);
  } catch (const config::Error&) {
    return path + "=" + scaled_list(node.numbers(key, -1), change);
  }
}

}  // namespace palpate::runs
