#pragma once

#include <cstddef>
#include <string>

namespace palpate::config {

/// Limits of a YAML text. Items and depth count the content of aliases (*name), because with these
/// a few lines can expand to a billion texts.
struct YamlLimits {
  const char* what = "document";  // name of the kind of text in error messages
  int depth = 50;
  int items = 100000;
  bool aliases = true;
};

/// Checks a text before it is parsed into nodes. Throws Error, with `name`, line and limit, if the
/// text is invalid YAML or exceeds a limit.
void check_limits(const std::string& text, const std::string& name, const YamlLimits& limits);

/// Content of a file. Throws Error if it cannot be read or has more than `largest` bytes.
std::string read_text(const std::string& path, std::size_t largest);

}  // namespace palpate::config
