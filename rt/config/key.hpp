#pragma once

#include <string>
#include <utility>

namespace palpate::config {

/// Key of a mapping entry. With unit and meaning it is a declaration: type, range and default are
/// those of the getter that receives it, and docs/configuration.md is generated from all
/// declarations (declarations.hpp). Unit "" means dimensionless.
struct Key {
  Key(const char* key) : name(key) {}             // NOLINT: a plain name is a key
  Key(std::string key) : name(std::move(key)) {}  // NOLINT
  Key(std::string key, const char* of_unit, const char* of_meaning)
      : name(std::move(key)), unit(of_unit), meaning(of_meaning) {}

  /// Key whose name is not defined by palpate, e.g. the name of a joint: `kind` (JOINT) represents
  /// it.
  static Key named_by_user(std::string key, const char* kind, const char* unit,
                           const char* meaning) {
    Key result(std::move(key), unit, meaning);
    result.kind = kind;
    return result;
  }

  std::string name;
  const char* unit = "";
  const char* meaning = "";
  const char* kind = nullptr;
};

}  // namespace palpate::config
