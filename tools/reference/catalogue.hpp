#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/reference/exploration.hpp"

namespace palpate::reference {

/// A parameter as all readings together tell it.
struct Parameter {
  std::string name;
  std::string type;
  std::string unit;
  std::string allowed;
  std::string meaning;
  std::vector<std::string> defaults;  // more than one where another choice changes it
  bool required = false;              // wherever it is asked for
  /// It is asked for only where the choices beside it are among these.
  std::map<std::string, std::set<std::string>> only_with;
};

/// A mapping of a document: "control.limits"; "sensing[]" for each item of a list.
struct Section {
  std::string path;
  std::vector<Parameter> parameters;
};

/// Sections as a tree, each level in the order in which it is first read. Those of a second arm
/// that are as the first arm's, and those of fallbacks, are left out.
std::vector<Section> merge(const std::vector<Declarations>& readings);

/// "path.name" of every parameter that no declaration tells the meaning of.
std::vector<std::string> untold(const std::vector<Section>& sections);

}  // namespace palpate::reference
