#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/reference/exploration.hpp"

namespace palpate::reference {

/// A parameter, merged from all readings.
struct Parameter {
  std::string name;
  std::string type;
  std::string unit;
  std::string allowed;
  std::string meaning;
  std::vector<std::string> defaults;  // more than one if another choice changes it
  bool required = false;              // wherever it is read
  /// It is read only if the other choices have one of these values.
  std::map<std::string, std::set<std::string>> only_with;
};

/// A mapping of a document: "control.limits"; "sensing[]" for each item of a list.
struct Section {
  std::string path;
  std::vector<Parameter> parameters;
};

/// Sections as a tree, each level in the order in which it is first read. Sections of a second arm
/// that equal the first arm's, and those of fallbacks, are omitted.
std::vector<Section> merge(const std::vector<Declarations>& readings);

/// "path.name" of every parameter without a description in its declaration.
std::vector<std::string> untold(const std::vector<Section>& sections);

}  // namespace palpate::reference
