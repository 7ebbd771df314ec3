#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/reference/catalogue.hpp"

// Parts of JSON Schemas: of one value of a document, whatever section it is in.
namespace palpate::reference {

using Json = nlohmann::ordered_json;

Json reference_to(const std::string& definition);

/// The value of YAML text as JSON: a number or flag if it is one, else text.
Json scalar(const std::string& text);

/// Null if there is none, or none that JSON expresses.
Json default_of(const Parameter& parameter);

/// A value of `type` ("number", "integer") within the parameter's range.
Json number(const char* type, const Parameter& parameter);

/// A list of `count` items; 0: of any number.
Json numbers(const Json& item, int count);

/// One of the parameter's choices, with their descriptions where there are any.
Json choice(const Parameter& parameter);

/// The same, or null.
Json or_null(Json schema);

/// What one of these allows, equal ones once.
Json any_of(const std::vector<Json>& schemas);

}  // namespace palpate::reference
