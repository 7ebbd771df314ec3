#include "tools/reference/schema.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/reference/value_schema.hpp"

namespace palpate::reference {
namespace {

/// Keys whose values may be names of plug-in components, in the sections at the top of a document.
const std::set<std::string> kNamesOfComponents = {"component", "provider", "law"};

/// True for NAME, JOINT, ...: the document gives the names.
bool is_any_name(const std::string& key) {
  return std::all_of(key.begin(), key.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// Name of the definition of a section: "sensing[].payload" is "sensing.item.payload".
std::string definition_of(const std::string& path) {
  std::string name;
  for (const char c : path) name += c == '[' ? ".item" : c == ']' ? "" : std::string(1, c);
  return name;
}

/// Definitions of the sections of one document, named `prefix`.<section>.
class Definitions {
 public:
  /// `partial`: another document, or other sections, provide keys that are missing; an empty entry
  /// removes a key.
  Definitions(const std::vector<Section>& sections, std::string prefix, bool partial)
      : sections_(sections), prefix_(std::move(prefix)), partial_(partial) {}

  /// All of them; that of the top level is `prefix`.
  Json all() const {
    Json definitions = Json::object();
    for (const Section& section : sections_)
      definitions[name_of(section.path)] = section_schema(section);
    return definitions;
  }

 private:
  using Group = std::vector<const Parameter*>;  // of one key

  std::string name_of(const std::string& path) const {
    return path.empty() ? prefix_ : prefix_ + "." + definition_of(path);
  }

  const Section* find(const std::string& path) const {
    for (const Section& section : sections_)
      if (section.path == path) return &section;
    return nullptr;
  }

  /// The section `key` of the section at `path`.
  Json child(const std::string& path, const std::string& key) const {
    const std::string above = path.empty() ? "" : path + ".";
    const std::string arm = "second_arm.";
    for (const std::string& name : {key, std::string("QUANTITY")}) {
      std::string full = above + name;
      // As those of the first arm, of which more keys are known.
      if (full.compare(0, arm.size(), arm) == 0 && find(full.substr(arm.size())) != nullptr)
        full = full.substr(arm.size());
      if (find(full) != nullptr) return reference_to(name_of(full));
    }
    if (key == "recording" || key == "recordings[]") return reference_to("recording");
    return {{"type", "object"}};
  }

  Json type_schema(const Parameter& parameter, const std::string& path) const {
    const std::string& type = parameter.type;
    if (type == "number") return number("number", parameter);
    if (type == "whole number") return number("integer", parameter);
    if (type == "flag") return {{"type", "boolean"}};
    if (type == "one of") return choice(parameter);
    if (type == "text") return {{"type", Json::array({"string", "number"})}};
    if (type == "file") return {{"type", "string"}};
    if (type == "pose") return reference_to("pose");
    if (type == "points") return numbers(numbers({{"type", "number"}}, 3), 0);
    if (type == "list of texts") return numbers({{"type", Json::array({"string", "number"})}}, 0);
    if (type == "number with unit")
      return {{"anyOf", {number("number", parameter), reference_to("quantity")}}};
    if (type == "section") return child(path, parameter.name);
    if (type == "list of sections")
      return {{"type", "array"},
              {"items",
               {{"allOf", Json::array({child(path, parameter.name + "[]")})}, {"type", "object"}}}};
    const std::size_t digits = type.find_first_not_of("0123456789");
    return numbers(number("number", parameter), digits == 0 ? 0 : std::stoi(type));
  }

  Json parameter_schema(const Parameter& parameter, const std::string& path) const {
    Json schema = type_schema(parameter, path);
    const bool is_section = parameter.type.find("section") != std::string::npos;
    const bool in_list = path.find("[]") != std::string::npos;
    const bool is_optional = (partial_ && !in_list) || (is_section && !parameter.required);
    // The definitions of sections and poses accept null.
    const bool is_reference = schema.contains("$ref");
    if (is_reference) schema = {{"allOf", Json::array({schema})}};
    if (is_reference && is_section && !is_optional) schema["type"] = "object";
    if (!is_reference && is_optional) schema = or_null(schema);
    std::string text = parameter.meaning;
    if (!parameter.unit.empty()) text += " [" + parameter.unit + "]";
    if (!text.empty()) schema["description"] = text;
    const Json otherwise = default_of(parameter);
    if (!otherwise.is_null()) schema["default"] = otherwise;
    return schema;
  }

  Json group_schema(const Group& group, const std::string& path) const {
    std::vector<Json> schemas;
    for (const Parameter* parameter : group) schemas.push_back(parameter_schema(*parameter, path));
    return any_of(schemas);
  }

  bool is_required(const Group& group, const std::string& path) const {
    const bool may_be_elsewhere = partial_ && path.find("[]") == std::string::npos;
    return !may_be_elsewhere &&
           std::all_of(group.begin(), group.end(), [](const Parameter* p) { return p->required; });
  }

  /// Schema that applies where the key `deciding` has the value `value`.
  Json branch(const Section& section, const std::map<std::string, Group>& groups,
              const Parameter& deciding, const std::string& value) const {
    Json properties = Json::object(), required = Json::array();
    for (const auto& [name, group] : groups) {
      Group here;
      bool decides = false, decided_before = false;
      for (const Parameter* parameter : group) {
        const auto with = parameter->only_with.find(deciding.name);
        decides = decides || with != parameter->only_with.end();
        if (with != parameter->only_with.end() && with->second.count(value) == 0) continue;
        here.push_back(parameter);
        decided_before = decided_before || (with != parameter->only_with.end() &&
                                            with != parameter->only_with.begin());
      }
      if (!decides) continue;
      if (here.empty()) {
        properties[name] = false;
      } else if (!decided_before) {
        properties[name] = group_schema(here, section.path);
        const bool alone = std::all_of(here.begin(), here.end(),
                                       [](const Parameter* p) { return p->only_with.size() == 1; });
        if (alone && is_required(here, section.path)) required.push_back(name);
      }
    }
    Json condition = {{"properties", {{deciding.name, {{"const", scalar(value)}}}}}};
    const bool is_default = deciding.defaults == std::vector<std::string>{value} && !partial_;
    if (!is_default) condition["required"] = Json::array({deciding.name});
    Json then = {{"properties", properties}};
    if (!required.empty()) then["required"] = required;
    return {{"if", condition}, {"then", then}};
  }

  Json section_schema(const Section& section) const {
    std::vector<std::string> order;
    std::map<std::string, Group> groups;
    std::set<std::string> deciding;
    for (const Parameter& parameter : section.parameters) {
      if (groups.count(parameter.name) == 0) order.push_back(parameter.name);
      groups[parameter.name].push_back(&parameter);
      for (const auto& [choice, values] : parameter.only_with) deciding.insert(choice);
    }
    Json properties = Json::object(), required = Json::array(), branches = Json::array();
    const bool has_quantities = find(section.path + ".QUANTITY") != nullptr;
    Json others = has_quantities ? child(section.path, "QUANTITY") : Json(false);
    for (const std::string& name : order) {
      const Group& group = groups[name];
      const bool always = std::all_of(group.begin(), group.end(),
                                      [](const Parameter* p) { return p->only_with.empty(); });
      const Json schema = always ? group_schema(group, section.path) : Json(true);
      if (is_any_name(name)) {
        others = schema;
        continue;
      }
      properties[name] = schema;
      if (always && is_required(group, section.path)) required.push_back(name);
      if (deciding.count(name) != 0)
        for (const auto& [value, description] : group[0]->choices)
          branches.push_back(branch(section, groups, *group[0], value));
    }
    if (section.path.empty() && prefix_.find("recording") == std::string::npos)
      properties["base"] = {{"type", "string"},
                            {"description", "File whose entries apply where this one has none"}};
    if (is_slot(section)) add_fallback(section, properties);
    Json schema = {
        {"type", "object"}, {"properties", properties}, {"additionalProperties", others}};
    if (!required.empty()) schema["required"] = required;
    if (!branches.empty()) schema["allOf"] = branches;
    if (section.path.empty()) accept_plugins(schema);
    return schema;
  }

  /// A section at the top of the document that names a component.
  static bool is_slot(const Section& section) {
    return section.path.find('.') == std::string::npos &&
           std::any_of(section.parameters.begin(), section.parameters.end(), [](const auto& p) {
             return kNamesOfComponents.count(p.name) != 0 && !p.choices.empty();
           });
  }

  void add_fallback(const Section& section, Json& properties) const {
    const Json fallback = {{"allOf", Json::array({reference_to(name_of(section.path))})},
                           {"description", "Component that takes over after an error of this one"}};
    Json& known = properties["fallback"];
    known = known.is_null()      ? fallback
            : known.is_boolean() ? Json(true)
                                 : any_of({known, fallback});
  }

  /// Components of plug-ins have names and keys that are unknown here.
  void accept_plugins(Json& schema) const {
    if (!schema["properties"].contains("plugins")) return;
    Json known = Json::object(), any = Json::object();
    for (const Section& section : sections_) {
      if (!is_slot(section)) continue;
      const bool is_list = section.path.back() == ']';
      const std::string key =
          is_list ? section.path.substr(0, section.path.size() - 2) : section.path;
      std::vector<Json> either = {reference_to(name_of(section.path))};
      for (const Parameter& parameter : section.parameters) {
        if (kNamesOfComponents.count(parameter.name) == 0) continue;
        either.push_back({{"type", "object"},
                          {"properties", {{parameter.name, {{"not", choice(parameter)}}}}},
                          {"required", Json::array({parameter.name})}});
      }
      const Json of_plugins = any_of(either);
      any[key] = is_list ? Json{{"items", of_plugins}} : of_plugins;
      known[key] = std::move(schema["properties"][key]);
      schema["properties"][key] = true;
    }
    schema["if"] = {{"required", Json::array({"plugins"})}};
    schema["then"] = {{"properties", any}};
    schema["else"] = {{"properties", known}};
  }

  const std::vector<Section>& sections_;
  std::string prefix_;
  bool partial_;
};

Json pose() {
  const Json three = numbers({{"type", "number"}}, 3);
  return {{"type", Json::array({"object", "null"})},
          {"properties",
           {{"position", three},
            {"quaternion", numbers({{"type", "number"}, {"minimum", -1}, {"maximum", 1}}, 4)},
            {"rpy_deg", numbers({{"type", "number"}, {"minimum", -360}, {"maximum", 360}}, 3)}}},
          {"additionalProperties", false},
          {"not", {{"required", Json::array({"quaternion", "rpy_deg"})}}}};
}

/// A recording of any kind, of which other sections may provide some keys.
Json recording(const std::map<std::string, std::vector<Section>>& kinds) {
  Json properties = Json::object(), branches = Json::array();
  for (const auto& [kind, sections] : kinds) {
    for (const Section& section : sections)
      for (const Parameter& parameter : section.parameters)
        if (section.path.empty()) properties[parameter.name] = true;
    branches.push_back(
        {{"if",
          {{"properties", {{"kind", {{"const", kind}}}}}, {"required", Json::array({"kind"})}}},
         {"then", reference_to("recording." + kind)}});
  }
  return {{"type", "object"},
          {"properties", properties},
          {"additionalProperties", false},
          {"allOf", branches}};
}

/// Sections that palpate-fit merges as text, so that no reader declares them: defaults of all
/// recordings, and what a variant or a fit puts over the sections of the plan.
void add_merged_sections(Json& definitions) {
  const Json recording = reference_to("recording"), solver = reference_to("partial.solver"),
             parameters = reference_to("partial.parameters");
  for (const std::string plan : {"complete", "partial"}) {
    definitions[plan]["properties"]["recording"] = recording;
    definitions[plan + ".variants.item"]["properties"].update(
        Json{{"recording", recording}, {"solver", solver}, {"parameters", parameters}});
    definitions[plan + ".fits.item"]["properties"]["parameters"] = parameters;
  }
}

/// The sections of an object come together; without them, palpated has sensor models only.
void add_object_sections(Json& configuration) {
  if (!configuration["properties"].contains("deformation")) return;
  const std::vector<std::string> needed = {"object", "estimation", "deformation", "feature",
                                           "control"};
  Json mappings = Json::object();
  for (const std::string& key : needed) mappings[key] = {{"type", "object"}};
  const Json whole = {{"required", needed}, {"properties", mappings}};
  for (const std::string& key : needed) configuration["dependencies"][key] = whole;
  for (const char* key : {"contact", "obstacles"}) configuration["dependencies"][key] = whole;
  configuration["anyOf"] = Json::array(
      {{{"required", Json::array({"object"})}}, {{"required", Json::array({"sensing"})}}});
}

}  // namespace

std::string write_schema(const SchemaDocument& document) {
  Json definitions = {
      {"pose", pose()},
      {"quantity", {{"type", "string"}, {"pattern", "^ *[-+.0-9][-+.0-9eE]* *[^ ].*$"}}}};
  definitions.update(Definitions(document.sections, "complete", false).all());
  definitions.update(Definitions(document.sections, "partial", true).all());
  for (const auto& [kind, sections] : document.recordings)
    definitions.update(Definitions(sections, "recording." + kind, true).all());
  if (!document.recordings.empty()) {
    definitions["recording"] = recording(document.recordings);
    add_merged_sections(definitions);
  }
  add_object_sections(definitions["complete"]);
  const Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                       {"title", document.title},
                       {"if", {{"required", Json::array({"base"})}}},
                       {"then", reference_to("partial")},
                       {"else", reference_to("complete")},
                       {"definitions", definitions}};
  return schema.dump() + "\n";
}

}  // namespace palpate::reference
