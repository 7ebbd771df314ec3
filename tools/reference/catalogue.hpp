#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "rt/config/declarations.hpp"

namespace palpate::reference {

/// All keys read from a document.
using Declarations = std::vector<config::Declaration>;

/// The keys of `file` that `read` reads; keys may be names given by the document (NAME).
Declarations declared_by(const std::string& file, const std::function<void()>& read);

/// One entry, NAME, for all keys of a section whose keys are names given by the document, and one,
/// QUANTITY, for those of columns.
Declarations without_names(Declarations declarations);

/// A parameter, merged from all readings.
struct Parameter {
  std::string name;
  std::string type;
  std::string unit;
  std::string allowed;
  std::string meaning;
  std::vector<std::string> defaults;  // more than one if another choice changes it
  bool required = false;              // wherever it is read
  config::Range range = {};           // of a number, the widest of all readings
  config::Choices choices = {};       // of a choice
  /// It is read only if the other choices have one of these values.
  std::map<std::string, std::set<std::string>> only_with;
};

/// A mapping of a document: "control.limits"; "sensing[]" for each item of a list.
struct Section {
  std::string path;
  std::vector<Parameter> parameters;
};

/// Sections as a tree, each level in the order in which it is first read, except those of
/// fallbacks.
std::vector<Section> all_sections(const std::vector<Declarations>& readings);

/// As all_sections(), for documentation: sections of a second arm that equal the first arm's
/// are omitted.
std::vector<Section> merge(const std::vector<Declarations>& readings);

/// "path.name" of every parameter without a description in its declaration.
std::vector<std::string> undescribed(const std::vector<Section>& sections);

}  // namespace palpate::reference
