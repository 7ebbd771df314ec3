#include "rt/config/document.hpp"

#include <charconv>

#include "core/math/fnv1a.hpp"
#include "rt/config/node.hpp"

namespace palpate::config {
namespace {

/// Deeper nesting than any configuration has; an alias that contains itself is endlessly deep.
constexpr int kMaxDepth = 50;

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

/// Sets the value at parts[i...] below `node`, a handle to the tree itself.
void assign(YAML::Node node, const std::vector<std::string>& parts, std::size_t i,
            const YAML::Node& value, const std::string& where) {
  const std::string& part = parts[i];
  const bool last = i + 1 == parts.size();
  if (node.IsSequence()) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (error != std::errc() || end != part.data() + part.size() || index >= node.size()) {
      throw Error(where + ": '" + part + "' is no item of the list; allowed: 0 to " +
                  std::to_string(static_cast<long>(node.size()) - 1));
    }
    if (last) {
      node[index] = value;
    } else {
      assign(node[index], parts, i + 1, value, where);
    }
  } else if (node.IsMap() || node.IsNull()) {
    if (last) {
      node[part] = value;
      return;
    }
    if (!node[part].IsDefined() || node[part].IsNull())
      node[part] = YAML::Node(YAML::NodeType::Map);
    assign(node[part], parts, i + 1, value, where);
  } else {
    throw Error(where + ": '" + parts[i - 1] + "' is a value and has no key '" + part + "'");
  }
}

}  // namespace

std::string join(const std::string& path, const std::string& key) {
  return path.empty() ? key : key.empty() ? path : path + "." + key;
}

Document::Document(const std::string& text, const std::string& name, const std::string& folder)
    : name_(name), folder_(folder) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) throw Error(name + ": holds more than one YAML document");
    if (!documents.empty()) root_ = documents.front();
  } catch (const YAML::Exception& error) {
    throw Error(location("", error.mark.line) + ": not valid YAML: " + error.msg);
  }
  if (root_.IsNull()) root_ = YAML::Node(YAML::NodeType::Map);
  if (!root_.IsMap()) throw Error(location("", root_.Mark().line) + ": not a mapping of keys");
  check_keys(root_, "", 0);
}

void Document::check_keys(const YAML::Node& node, const std::string& path, int depth) const {
  if (depth > kMaxDepth) {
    throw Error(location(path, node.Mark().line) + ": " + path + ": nested too deeply");
  }
  std::set<std::string> seen;
  int index = 0;
  for (const auto& entry : node) {
    if (!node.IsMap()) {
      check_keys(entry, join(path, std::to_string(index++)), depth + 1);
      continue;
    }
    if (!entry.first.IsScalar()) {
      throw Error(location(path, entry.first.Mark().line) + ": " + path +
                  ": a key is not plain text");
    }
    const std::string key = join(path, entry.first.Scalar());
    // yaml-cpp would silently keep the first of two.
    if (!seen.insert(key).second) {
      throw Error(location(key, entry.first.Mark().line) + ": " + key + ": given twice");
    }
    check_keys(entry.second, key, depth + 1);
  }
}

void Document::apply_override(const std::string& text) {
  const std::string where = "override '" + text + "'";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw Error(where + ": must read path.to.key=value");
  }
  const std::string path = text.substr(0, equals);
  const std::vector<std::string> parts = split(path);
  for (const std::string& part : parts) {
    if (part.empty()) throw Error(where + ": the path has an empty key");
  }
  YAML::Node value;
  try {
    value = YAML::Load(text.substr(equals + 1));
  } catch (const YAML::Exception& error) {
    throw Error(where + ": not valid YAML: " + error.msg);
  }
  assign(root_, parts, 0, value, where);
  overrides_.push_back({path, text});
  check_keys(value, path, 0);
}

std::string Document::location(const std::string& path, int line) const {
  for (auto it = overrides_.rbegin(); it != overrides_.rend(); ++it) {
    const bool at_or_below = path == it->path || starts_with(path, it->path + ".");
    // A mapping without a line was made on the way to an overridden key.
    const bool made_for_it = line < 0 && starts_with(it->path, path + ".");
    if (at_or_below || made_for_it) return "override '" + it->text + "'";
  }
  return line < 0 ? name_ : name_ + ":" + std::to_string(line + 1);
}

const std::set<std::string>& Document::used(const std::string& path) const {
  static const std::set<std::string> kNone;
  const auto found = used_.find(path);
  return found == used_.end() ? kNone : found->second;
}

std::int64_t Document::hash() const { return math::Fnv1a().add(YAML::Dump(root_)).signed_value(); }

}  // namespace palpate::config
