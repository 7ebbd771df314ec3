#include "tools/export/foreign_json.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/common/base64.hpp"
#include "tools/export/json_schema.hpp"
#include "tools/log/record.hpp"

namespace palpate::exporting {
namespace {

using Json = nlohmann::ordered_json;

class JsonHandler : public types::Handler {
 public:
  explicit JsonHandler(std::string& text) : text_(text) {}

  void begin_struct(const types::Struct&) override {
    text_ += '{';
    depths_.push_back(0);
  }
  void end_struct() override {
    text_ += '}';
    depths_.pop_back();
  }
  void begin_member(const types::Member& member, int index) override {
    if (index > 0) text_ += ',';
    text_ += '"' + member.name + "\":";
  }
  void begin_array(std::int64_t) override { text_ += depths_.back()++ > 0 ? "{\"values\":[" : "["; }
  void begin_element(std::int64_t index) override {
    if (index > 0) text_ += ',';
  }
  void end_array() override { text_ += --depths_.back() > 0 ? "]}" : "]"; }

  void integer(const types::Member& member, std::int64_t value) override {
    if (member.kind == types::Kind::kBoolean)
      text_ += value != 0 ? "true" : "false";
    else
      text_ += std::to_string(value);
  }
  void real(const types::Member& member, double value) override {
    if (!std::isfinite(value))
      text_ += "null";
    else if (member.kind == types::Kind::kFloat)
      log::append_number(static_cast<float>(value), text_);
    else
      log::append_number(value, text_);
  }
  void text(const types::Member&, std::string_view value) override {
    append_json_string(std::string(value), text_);
  }
  void bytes(const types::Member&, const std::uint8_t* data, std::int64_t size) override {
    text_ += '"' + common::to_base64(data, static_cast<std::size_t>(size)) + '"';
  }

 private:
  std::string& text_;
  std::vector<int> depths_;  // of arrays, for each open struct
};

Json schema_of(const types::Struct& type, std::vector<const types::Struct*>& parents);

Json value_schema(const types::Member& member, std::vector<const types::Struct*>& parents) {
  switch (member.kind) {
    case types::Kind::kStruct:
      return schema_of(*member.content, parents);
    case types::Kind::kString:
      return {{"type", "string"}};
    case types::Kind::kBoolean:
      return {{"type", "boolean"}};
    case types::Kind::kFloat:
    case types::Kind::kDouble:
      return {{"type", "number"}};
    default:
      return {{"type", "integer"}};
  }
}

Json schema_of(const types::Struct& type, std::vector<const types::Struct*>& parents) {
  if (std::find(parents.begin(), parents.end(), &type) != parents.end())
    return {{"type", "object"}};
  parents.push_back(&type);
  Json properties = Json::object();
  Json required = Json::array();
  for (const types::Member& member : type.members) {
    std::size_t dimensions = member.dimensions.size();
    Json schema = value_schema(member, parents);
    if (member.kind == types::Kind::kByte && dimensions > 0) {
      schema = {{"type", "string"}, {"contentEncoding", "base64"}};
      --dimensions;
    }
    for (std::size_t d = 0; d < dimensions; ++d) {
      if (d > 0) schema = {{"type", "object"}, {"properties", {{"values", schema}}}};
      schema = {{"type", "array"}, {"items", schema}};
    }
    if (!member.comment.empty()) schema["description"] = member.comment;
    properties[member.name] = schema;
    required.push_back(member.name);
  }
  parents.pop_back();
  return {{"type", "object"}, {"properties", properties}, {"required", required}};
}

}  // namespace

nlohmann::ordered_json json_schema(const types::Struct& type) {
  std::vector<const types::Struct*> parents;
  Json schema = schema_of(type, parents);
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = type.name;
  schema["description"] = type.comment;
  return schema;
}

bool append_json(const types::Struct& type, const void* data, int size, std::string& text) {
  JsonHandler handler(text);
  return types::decode(type, data, size, handler);
}

}  // namespace palpate::exporting
