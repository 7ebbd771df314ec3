#pragma once

#include <string>
#include <utility>

namespace palpate::config {

/// Which entry of a mapping is asked for. With a unit and a meaning it is a declaration: type,
/// range and default are those of the getter that it is given to, and docs/configuration.md is made
/// of all of them (declarations.hpp). Unit "" stands for a number without one.
struct Key {
  Key(const char* key) : name(key) {}             // NOLINT: a plain name is a key
  Key(std::string key) : name(std::move(key)) {}  // NOLINT
  Key(std::string key, const char* of_unit, const char* of_meaning)
      : name(std::move(key)), unit(of_unit), meaning(of_meaning) {}

  /// A key that is not palpate's to name, as that of a joint: `kind` (JOINT) stands for it.
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
