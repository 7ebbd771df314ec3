#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rt/config/option.hpp"

namespace palpate::config {

/// Names that a key allows, each with a one-line description ("": none).
using Choices = std::vector<std::pair<std::string, std::string>>;

/// Configuration parameter as declared by its reader.
struct Declaration {
  std::string document;  // name of the configuration file
  std::string path;      // path of the mapping that contains the key; list items by number
  std::string name;
  std::string type;      // number, whole number, flag, text, file, one of, section, ...
  std::string unit;      // "": none
  std::string meaning;   // "": not given
  std::string allowed;   // range or choices; "": any value of the type
  std::string fallback;  // meaning of an absent key, as YAML; "" for a required key or a section
  bool required = false;
  bool present = false;  // present in the configuration
  std::string value;     // value read, for a choice
  Range range = {};      // of a number, or of each of several
  Choices choices = {};  // of a choice
};

/// During its lifetime, lists every parameter that this thread reads from any Node, each key of a
/// document once. At most one per thread.
class DeclarationList {
 public:
  DeclarationList();
  ~DeclarationList();
  DeclarationList(const DeclarationList&) = delete;
  DeclarationList& operator=(const DeclarationList&) = delete;

  const std::vector<Declaration>& all() const { return declarations_; }

  /// The active list of this thread; nullptr: none.
  static DeclarationList* current();
  void add(Declaration declaration);
  /// The entry for this key; nullptr: none.
  Declaration* find(const std::string& document, const std::string& path, const std::string& name);

 private:
  std::vector<Declaration> declarations_;
};

}  // namespace palpate::config
