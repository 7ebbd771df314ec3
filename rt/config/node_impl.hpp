#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/math/parse_number.hpp"
#include "rt/config/declarations.hpp"
#include "rt/config/document.hpp"
#include "rt/config/node.hpp"

// Helpers shared by the getters of Node; for node.cpp and node_values.cpp only.
namespace palpate::config {

inline std::string range_text(Range range) {
  std::ostringstream text;
  text.precision(10);
  if (std::isinf(range.lower) && std::isinf(range.upper)) {
    text << "any finite number";
  } else if (std::isinf(range.upper)) {
    text << "at least " << range.lower;
  } else if (std::isinf(range.lower)) {
    text << "at most " << range.upper;
  } else {
    text << range.lower << " to " << range.upper;
  }
  return text.str();
}

inline bool is_unlimited(Range range) { return std::isinf(range.lower) && std::isinf(range.upper); }

inline std::string number_text(double number) {
  std::ostringstream text;
  text.precision(6);
  text << number;
  return text.str();
}

/// During its lifetime no declarations are listed, because what is read is part of one parameter.
class Undeclared {
 public:
  Undeclared() { ++depth(); }
  ~Undeclared() { --depth(); }
  Undeclared(const Undeclared&) = delete;
  Undeclared& operator=(const Undeclared&) = delete;
  static bool now() { return depth() > 0; }

 private:
  static int& depth() {
    static thread_local int count = 0;
    return count;
  }
};

inline std::string allowed(Range range) { return "; allowed: " + range_text(range); }

template <typename List>
inline std::string listed(const List& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text.empty() ? "nothing" : text;
}

/// True for an unquoted scalar (a quoted number is text).
inline bool is_plain(const YAML::Node& node) { return node.IsScalar() && node.Tag() != "!"; }

inline std::string shown(const YAML::Node& node) {
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  if (node.IsSequence()) return "a list";
  return node.IsMap() ? "a mapping" : "nothing";
}

struct Node::Impl {
  std::shared_ptr<Document> document;
  YAML::Node node;   // mapping; null if the key is absent
  std::string path;  // full key
  int line = -1;     // 0-based

  struct Entry {
    bool present = false;
    YAML::Node value;
    int line = -1;
  };

  /// The entry without marking it as used.
  Entry peek(const std::string& key) const {
    if (node.IsMap()) {
      for (const auto& entry : node) {
        if (entry.first.Scalar() == key) return {true, entry.second, entry.first.Mark().line};
      }
    }
    return {false, YAML::Node(), line};
  }

  Entry find(const std::string& key) const {
    document->mark_used(path, key);
    return peek(key);
  }

  /// Lists the parameter if a list is active; the returned declaration may be completed by the
  /// caller.
  Declaration& declare(const Key& key, const std::string& type, Range range = {}) const {
    static thread_local Declaration nobodys;
    DeclarationList* list = DeclarationList::current();
    nobodys = {};
    if (list == nullptr || Undeclared::now()) return nobodys;
    const Entry entry = peek(key.name);
    const std::string name = key.kind != nullptr ? key.kind : key.name;
    Declaration* known = list->find(document->name(), path, name);
    if (known != nullptr && known->type == "text" && type == "one of") {
      known->type = type;  // read as text at first, then as a choice with known alternatives
      if (*key.meaning != '\0') known->meaning = key.meaning;
      return *known;
    }
    Declaration declaration;
    declaration.document = document->name();
    declaration.path = path;
    declaration.name = name;
    declaration.type = type;
    declaration.unit = key.unit;
    declaration.meaning = key.meaning;
    if (type.find("number") != std::string::npos && !is_unlimited(range))
      declaration.allowed = range_text(range);
    declaration.range = range;
    declaration.present = entry.present;
    if (entry.present && entry.value.IsScalar()) declaration.value = entry.value.Scalar();
    list->add(declaration);
    return known != nullptr ? nobodys : *list->find(document->name(), path, name);
  }

  Entry require(const std::string& key, const std::string& kind) const {
    Entry entry = find(key);
    if (!entry.present) fail(key, entry.line, "is missing; allowed: " + kind);
    return entry;
  }

  /// Adds a line to the document's warnings.
  void warn(const std::string& key, const std::string& what) const {
    const std::string full = join(path, key);
    document->warn(document->location(full, peek(key).line) + ": " + full + ": " + what);
  }

  [[noreturn]] void fail(const std::string& key, int at, const std::string& what) const {
    const std::string full = join(path, key);
    throw Error(document->location(full, at) + ": " + (full.empty() ? "" : full + ": ") + what);
  }

  double to_number(const YAML::Node& value, const std::string& key, int at, Range range) const {
    double number = 0;
    if (!is_plain(value) || !math::parse_number(value.Scalar(), number) || !std::isfinite(number)) {
      fail(key, at, shown(value) + " is not a finite number" + allowed(range));
    }
    if (!(number >= range.lower && number <= range.upper)) {
      fail(key, at, shown(value) + " is out of range" + allowed(range));
    }
    return number;
  }

  std::vector<double> to_numbers(const YAML::Node& value, const std::string& key, int at, int count,
                                 Range range) const {
    const bool any = count < 0;
    if (!value.IsSequence() || (!any && static_cast<int>(value.size()) != count)) {
      fail(key, at,
           "must be a list of " + (any ? "" : std::to_string(count) + " ") + "numbers" +
               allowed(range));
    }
    std::vector<double> numbers;
    for (const auto& item : value) {
      const std::string item_key = join(key, std::to_string(numbers.size()));
      numbers.push_back(to_number(item, item_key, item.Mark().line, range));
    }
    return numbers;
  }
};

}  // namespace palpate::config
