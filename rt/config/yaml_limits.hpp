#pragma once

#include <string>

namespace palpate::config {

/// How large a YAML text may become. Items and depth count what aliases (*name) stand for, by which
/// a few lines can mean a billion texts.
struct YamlLimits {
  const char* what = "document";  // what errors call it
  int depth = 50;
  int items = 100000;
  bool aliases = true;
};

/// Looks at a text as it is written, before anything is built of it. Throws Error, which names
/// `name`, the line and the limit, where the text is not valid YAML or beyond a limit.
void check_limits(const std::string& text, const std::string& name, const YamlLimits& limits);

}  // namespace palpate::config
