#include "tools/export/foxglove_schemas.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate::exporting {
namespace {

using Json = nlohmann::ordered_json;
using Kind = FoxgloveField::Kind;

constexpr const char* kPackage = "foxglove.";

FoxgloveField number(const char* name) { return {name, Kind::kDouble}; }
FoxgloveField text(const char* name) { return {name, Kind::kText}; }
FoxgloveField flag(const char* name) { return {name, Kind::kFlag}; }
FoxgloveField part(const char* name, const char* message) {
  return {name, Kind::kMessage, message};
}
FoxgloveField list(const char* name, const char* message) {
  return {name, Kind::kMessage, message, true};
}
FoxgloveField indices() { return {"indices", Kind::kFixed32, nullptr, true}; }
FoxgloveField timestamp() { return {"timestamp", Kind::kTime}; }

const FoxgloveMessage& find(const std::string& name) {
  const auto& all = foxglove_messages();
  const auto found = std::find_if(all.begin(), all.end(), [&name](const FoxgloveMessage& message) {
    return kPackage + std::string(message.name) == name;
  });
  if (found == all.end()) throw std::invalid_argument("no Foxglove schema " + name);
  return *found;
}

Json object(const Json& properties) { return {{"type", "object"}, {"properties", properties}}; }

Json schema_of(const FoxgloveMessage& message);

Json schema_of(const FoxgloveField& field) {
  switch (field.kind) {
    case Kind::kDouble:
      return {{"type", "number"}};
    case Kind::kFlag:
      return {{"type", "boolean"}};
    case Kind::kText:
      return {{"type", "string"}};
    case Kind::kBytes:
      return {{"type", "string"}, {"contentEncoding", "base64"}};
    case Kind::kMessage:
      return schema_of(find(kPackage + std::string(field.message)));
    case Kind::kTime:
    case Kind::kDuration:
      return object({{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}});
    case Kind::kFixed32:
    case Kind::kChoice:
      break;
  }
  return {{"type", "integer"}};
}

Json schema_of(const FoxgloveMessage& message) {
  Json properties = Json::object();
  for (const FoxgloveField& field : message.fields) {
    const Json one = schema_of(field);
    properties[field.name] = field.is_list ? Json{{"type", "array"}, {"items", one}} : one;
  }
  return object(properties);
}

}  // namespace

const std::vector<FoxgloveMessage>& foxglove_messages() {
  static const std::vector<FoxgloveMessage> messages = {
      {"Vector3", {number("x"), number("y"), number("z")}},
      {"Point3", {number("x"), number("y"), number("z")}},
      {"Quaternion", {number("x"), number("y"), number("z"), number("w")}},
      {"Pose", {part("position", "Vector3"), part("orientation", "Quaternion")}},
      {"Color", {number("r"), number("g"), number("b"), number("a")}},
      {"KeyValuePair", {text("key"), text("value")}},
      {"ArrowPrimitive",
       {part("pose", "Pose"), number("shaft_length"), number("shaft_diameter"),
        number("head_length"), number("head_diameter"), part("color", "Color")}},
      {"CubePrimitive", {part("pose", "Pose"), part("size", "Vector3"), part("color", "Color")}},
      {"SpherePrimitive", {part("pose", "Pose"), part("size", "Vector3"), part("color", "Color")}},
      {"CylinderPrimitive",
       {part("pose", "Pose"), part("size", "Vector3"), number("bottom_scale"), number("top_scale"),
        part("color", "Color")}},
      {"LinePrimitive",
       {{"type", Kind::kChoice},
        part("pose", "Pose"),
        number("thickness"),
        flag("scale_invariant"),
        list("points", "Point3"),
        part("color", "Color"),
        list("colors", "Color"),
        indices()},
       "Type",
       {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"}},
      {"TriangleListPrimitive",
       {part("pose", "Pose"), list("points", "Point3"), part("color", "Color"),
        list("colors", "Color"), indices()}},
      {"TextPrimitive",
       {part("pose", "Pose"), flag("billboard"), number("font_size"), flag("scale_invariant"),
        part("color", "Color"), text("text")}},
      {"ModelPrimitive",
       {part("pose", "Pose"),
        part("scale", "Vector3"),
        part("color", "Color"),
        flag("override_color"),
        text("url"),
        text("media_type"),
        {"data", Kind::kBytes}}},
      {"SceneEntity",
       {timestamp(),
        text("frame_id"),
        text("id"),
        {"lifetime", Kind::kDuration},
        flag("frame_locked"),
        list("metadata", "KeyValuePair"),
        list("arrows", "ArrowPrimitive"),
        list("cubes", "CubePrimitive"),
        list("spheres", "SpherePrimitive"),
        list("cylinders", "CylinderPrimitive"),
        list("lines", "LinePrimitive"),
        list("triangles", "TriangleListPrimitive"),
        list("texts", "TextPrimitive"),
        list("models", "ModelPrimitive")}},
      {"SceneEntityDeletion",
       {timestamp(), {"type", Kind::kChoice}, text("id")},
       "Type",
       {"MATCHING_ID", "ALL"}},
      {"SceneUpdate", {list("deletions", "SceneEntityDeletion"), list("entities", "SceneEntity")}},
      {"PoseInFrame", {timestamp(), text("frame_id"), part("pose", "Pose")}},
      {"FrameTransform",
       {timestamp(), text("parent_frame_id"), text("child_frame_id"),
        part("translation", "Vector3"), part("rotation", "Quaternion")}},
      {"PackedElementField",
       {text("name"), {"offset", Kind::kFixed32}, {"type", Kind::kChoice}},
       "NumericType",
       {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"}},
      {"PointCloud",
       {timestamp(),
        text("frame_id"),
        part("pose", "Pose"),
        {"point_stride", Kind::kFixed32},
        list("fields", "PackedElementField"),
        {"data", Kind::kBytes}}}};
  return messages;
}

nlohmann::ordered_json foxglove_schema(const std::string& name) {
  Json schema = schema_of(find(name));
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = name;
  return schema;
}

}  // namespace palpate::exporting
