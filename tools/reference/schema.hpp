#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/reference/catalogue.hpp"

namespace palpate::reference {

/// What a schema describes: one kind of YAML document.
struct SchemaDocument {
  std::string title;
  std::vector<Section> sections;  // of all_sections()
  /// Sections of each kind of item of the list `recordings`, by the value of its key `kind`; the
  /// section `recording` holds defaults for all items.
  std::map<std::string, std::vector<Section>> recordings = {};
};

/// JSON Schema (draft-07) of the document: types, ranges, defaults, choices and descriptions of all
/// keys; keys that only some components have are allowed with these components only. A document
/// with the key `base` may omit any key and remove keys of its base.
std::string write_schema(const SchemaDocument& document);

}  // namespace palpate::reference
