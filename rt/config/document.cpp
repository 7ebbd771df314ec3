#include "rt/config/document.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "core/math/fnv1a.hpp"
#include "rt/config/node.hpp"
#include "rt/config/yaml_limits.hpp"

namespace palpate::config {
namespace {

/// far above any real configuration; texts that replace components come from the network
constexpr YamlLimits kLimits{"configuration", 50, 100000, true};
constexpr std::size_t kLargestFile = std::size_t{4} << 20;  // bytes

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

/// Merges `upper` over `lower`, both mappings; an empty entry removes that of `lower`. Key nodes
/// are kept, because they contain their line numbers.
YAML::Node merged(const YAML::Node& lower, const YAML::Node& upper) {
  YAML::Node result(YAML::NodeType::Map);
  for (const auto& entry : lower) {
    const std::string& key = entry.first.Scalar();
    const auto over = std::find_if(upper.begin(), upper.end(),
                                   [&](const auto& item) { return item.first.Scalar() == key; });
    if (over == upper.end()) {
      result.force_insert(entry.first, entry.second);
    } else if (over->second.IsNull()) {
      continue;
    } else if (over->second.IsMap() && entry.second.IsMap()) {
      result.force_insert(over->first, merged(entry.second, over->second));
    } else {
      result.force_insert(over->first, over->second);
    }
  }
  for (const auto& entry : upper)
    if (!lower[entry.first.Scalar()].IsDefined()) result.force_insert(entry.first, entry.second);
  return result;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

/// Index of the list item named by `part`.
std::size_t item_of(const YAML::Node& list, const std::string& part, const std::string& where) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error != std::errc() || end != part.data() + part.size() || index >= list.size()) {
    throw Error(where + ": '" + part + "' is no item of the list; allowed: 0 to " +
                std::to_string(static_cast<long>(list.size()) - 1));
  }
  return index;
}

/// Sets the value at parts[i...] below `node`, a handle to the tree itself; an empty value removes
/// the key.
void assign(YAML::Node node, const std::vector<std::string>& parts, std::size_t i,
            const YAML::Node& value, const std::string& where) {
  const std::string& part = parts[i];
  const bool last = i + 1 == parts.size();
  if (node.IsSequence()) {
    const std::size_t index = item_of(node, part, where);
    if (last) {
      node[index] = value;
    } else {
      assign(node[index], parts, i + 1, value, where);
    }
  } else if (node.IsMap() || node.IsNull()) {
    if (last && value.IsNull()) {
      if (!node.remove(part)) throw Error(where + ": there is no key to take away");
      return;
    }
    if (last) {
      node[part] = value;
      return;
    }
    if (!node[part].IsDefined() || node[part].IsNull())
      node[part] = YAML::Node(YAML::NodeType::Map);
    assign(node[part], parts, i + 1, value, where);
  } else {
    const std::string above = i == 0 ? "" : parts[i - 1];
    throw Error(where + ": '" + above + "' is a value and has no key '" + part + "'");
  }
}

}  // namespace

std::string join(const std::string& path, const std::string& key) {
  return path.empty() ? key : key.empty() ? path : path + "." + key;
}

Document::Document(const std::string& text, const std::string& name, const std::string& folder)
    : top_{name, folder} {
  check_limits(text, name, kLimits);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) throw Error(name + ": holds more than one YAML document");
    if (!documents.empty()) root_ = documents.front();
  } catch (const YAML::Exception& error) {
    throw Error(location("", error.mark.line) + ": not valid YAML: " + error.msg);
  }
  if (root_.IsNull()) root_ = YAML::Node(YAML::NodeType::Map);
  if (!root_.IsMap()) throw Error(location("", root_.Mark().line) + ": not a mapping of keys");
  check_keys(root_, "");
  claim(root_, "");
}

std::shared_ptr<Document> Document::load(const std::string& path) {
  std::vector<std::string> chain;
  return load_chain(path, chain);
}

std::shared_ptr<Document> Document::load_chain(const std::string& path,
                                               std::vector<std::string>& chain) {
  namespace fs = std::filesystem;
  const std::string folder = fs::path(path).parent_path().string();
  const auto document = std::make_shared<Document>(read_text(path, kLargestFile), path, folder);
  chain.push_back(fs::weakly_canonical(path).string());
  std::string where;
  const std::string name = document->take_base(where);
  if (name.empty()) return document;
  const std::string base = (fs::path(folder) / name).lexically_normal().string();
  if (std::count(chain.begin(), chain.end(), fs::weakly_canonical(base).string()) > 0)
    throw Error(where + "'" + base + "' builds on this file itself");
  if (!fs::is_regular_file(base)) throw Error(where + "there is no file '" + base + "'");
  document->put_over(*load_chain(base, chain));
  return document;
}

std::string Document::take_base(std::string& where) {
  for (const auto& entry : root_) {
    if (entry.first.Scalar() != "base") continue;
    where = location("base", entry.first.Mark().line) + ": base: ";
    if (!entry.second.IsScalar() || entry.second.Scalar().empty())
      throw Error(where + "is not the name of a file");
    const std::string name = entry.second.Scalar();
    root_.remove("base");
    return name;
  }
  return "";
}

void Document::put_over(const Document& base) {
  root_ = merged(base.root_, root_);
  // Except for keys that exist already.
  sources_.insert(base.sources_.begin(), base.sources_.end());
}

void Document::claim(const YAML::Node& node, const std::string& path) {
  for (const auto& entry : node) {
    const std::string key = join(path, entry.first.Scalar());
    sources_[key] = top_;
    if (entry.second.IsMap()) claim(entry.second, key);
  }
}

const Document::Source& Document::source(const std::string& path) const {
  for (std::string key = path; !key.empty();) {
    const auto found = sources_.find(key);
    if (found != sources_.end()) return found->second;
    const std::size_t dot = key.rfind('.');
    key.resize(dot == std::string::npos ? 0 : dot);
  }
  return top_;
}

void Document::check_keys(const YAML::Node& node, const std::string& path) const {
  std::set<std::string> seen;
  int index = 0;
  for (const auto& entry : node) {
    if (!node.IsMap()) {
      check_keys(entry, join(path, std::to_string(index++)));
      continue;
    }
    if (!entry.first.IsScalar()) {
      throw Error(location(path, entry.first.Mark().line) + ": " + path +
                  ": a key is not plain text");
    }
    const std::string key = join(path, entry.first.Scalar());
    // yaml-cpp would silently keep the first of two
    if (!seen.insert(key).second) {
      throw Error(location(key, entry.first.Mark().line) + ": " + key + ": given twice");
    }
    check_keys(entry.second, key);
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
  check_limits(text.substr(equals + 1), where, kLimits);
  try {
    value = YAML::Load(text.substr(equals + 1));
  } catch (const YAML::Exception& error) {
    throw Error(where + ": not valid YAML: " + error.msg);
  }
  if (value.IsNull() && equals + 1 == text.size())  // an unset shell variable
    throw Error(where + ": has no value; path.to.key=~ takes a key away");
  assign(root_, parts, 0, value, where);
  add_override(path, text);
  check_keys(value, path);
}

std::shared_ptr<Document> Document::changed(const std::string& path, const std::string& text,
                                            bool replace, const std::string& name) const {
  const Document change(text, name, top_.folder);
  const std::shared_ptr<Document> result(new Document());
  result->root_ = YAML::Clone(root_);
  result->top_ = top_;
  result->sources_ = sources_;
  result->overrides_ = overrides_;
  if (path.empty()) {
    result->root_ = replace ? YAML::Clone(change.root_) : merged(result->root_, change.root_);
    for (const auto& entry : change.root_) result->add_override(entry.first.Scalar(), name);
    return result;
  }
  YAML::Node value = YAML::Clone(change.root_);
  if (!replace) {
    YAML::Node present = result->root_;
    for (const std::string& part : split(path)) {
      // Assignment would modify the tree; reset() moves the handle.
      const bool in_list = present.IsSequence();
      const bool known = in_list || (present.IsMap() && present[part].IsDefined());
      if (!known) throw Error(name + ": there is no " + path);
      const YAML::Node next = in_list ? present[item_of(present, part, name)] : present[part];
      present.reset(next);
    }
    if (!present.IsMap()) throw Error(name + ": " + path + " is not a mapping of keys");
    value = merged(present, value);
  }
  assign(result->root_, split(path), 0, value, name);
  result->add_override(path, name);
  return result;
}

void Document::add_override(const std::string& path, const std::string& text) {
  // a value changed repeatedly is stored once
  overrides_.erase(std::remove_if(overrides_.begin(), overrides_.end(),
                                  [&](const Override& before) {
                                    return before.path == path && before.text == text;
                                  }),
                   overrides_.end());
  overrides_.push_back({path, text});
}

std::string Document::location(const std::string& path, int line) const {
  for (auto it = overrides_.rbegin(); it != overrides_.rend(); ++it) {
    const bool at_or_below = path == it->path || starts_with(path, it->path + ".");
    // A mapping without a line was created on the path to an overridden key.
    const bool made_for_it = line < 0 && starts_with(it->path, path + ".");
    if (at_or_below || made_for_it) return "override '" + it->text + "'";
  }
  const std::string& name = source(path).name;
  return line < 0 ? name : name + ":" + std::to_string(line + 1);
}

const std::set<std::string>& Document::used(const std::string& path) const {
  static const std::set<std::string> kNone;
  const auto found = used_.find(path);
  return found == used_.end() ? kNone : found->second;
}

void Document::warn(const std::string& text) {
  if (std::count(warnings_.begin(), warnings_.end(), text) == 0) warnings_.push_back(text);
}

std::int64_t Document::hash() const { return math::Fnv1a().add(YAML::Dump(root_)).signed_value(); }

}  // namespace palpate::config
