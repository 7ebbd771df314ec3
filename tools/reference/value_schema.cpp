#include "tools/reference/value_schema.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace palpate::reference {
namespace {

/// Without a fraction where the number is whole.
Json shortest(double number) {
  const bool is_whole = number == std::round(number) && std::abs(number) < 1e15;
  return is_whole ? Json(static_cast<long>(number)) : Json(number);
}

}  // namespace

Json reference_to(const std::string& definition) {
  return {{"$ref", "#/definitions/" + definition}};
}

Json scalar(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && rest == end && std::isfinite(number)) return shortest(number);
  if (text == "true" || text == "false") return text == "true";
  return text == "\"\"" ? "" : text;
}

Json default_of(const Parameter& parameter) {
  if (parameter.defaults.size() != 1 || parameter.type == "pose") return nullptr;
  const std::string& text = parameter.defaults[0];
  if (text.front() != '[') {
    const bool is_text = parameter.type == "text" || parameter.type == "file";
    return is_text ? Json(text == "\"\"" ? "" : text) : scalar(text);
  }
  Json list = Json::array();
  for (const auto& item : YAML::Load(text)) list.push_back(scalar(item.Scalar()));
  return list;
}

Json number(const char* type, const Parameter& parameter) {
  Json schema = {{"type", type}};
  if (std::isfinite(parameter.range.lower)) schema["minimum"] = shortest(parameter.range.lower);
  if (std::isfinite(parameter.range.upper)) schema["maximum"] = shortest(parameter.range.upper);
  return schema;
}

Json numbers(const Json& item, int count) {
  Json schema = {{"type", "array"}, {"items", item}};
  if (count == 0) return schema;
  schema["minItems"] = count;
  schema["maxItems"] = count;
  return schema;
}

Json choice(const Parameter& parameter) {
  Json names = Json::array(), descriptions = Json::array();
  bool described = false;
  for (const auto& [name, description] : parameter.choices) {
    names.push_back(scalar(name));
    descriptions.push_back(description);
    described = described || !description.empty();
  }
  Json schema = {{"enum", names}};
  if (described) schema["enumDescriptions"] = descriptions;
  return schema;
}

Json or_null(Json schema) {
  if (schema.is_boolean()) return schema;
  if (schema.contains("enum")) schema["enum"].push_back(nullptr);
  if (schema.contains("type")) {
    Json types = schema["type"].is_array() ? schema["type"] : Json::array({schema["type"]});
    types.push_back("null");
    schema["type"] = types;
  } else if (!schema.contains("enum")) {
    Json either = {{"anyOf", {schema, {{"type", "null"}}}}};
    return either;
  }
  return schema;
}

Json any_of(const std::vector<Json>& schemas) {
  std::vector<Json> distinct;
  for (const Json& schema : schemas)
    if (std::find(distinct.begin(), distinct.end(), schema) == distinct.end())
      distinct.push_back(schema);
  return distinct.size() == 1 ? distinct[0] : Json{{"anyOf", distinct}};
}

}  // namespace palpate::reference
