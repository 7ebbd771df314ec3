#include <stdexcept>

#include "tools/export/foxglove.hpp"

namespace palpate::exporting {
namespace {

using Json = nlohmann::ordered_json;

Json number() { return {{"type", "number"}}; }
Json integer() { return {{"type", "integer"}}; }
Json text() { return {{"type", "string"}}; }
Json flag() { return {{"type", "boolean"}}; }
Json object(const Json& properties) { return {{"type", "object"}, {"properties", properties}}; }
Json list(const Json& items) { return {{"type", "array"}, {"items", items}}; }

Json numbers(const std::vector<std::string>& names) {
  Json properties = Json::object();
  for (const std::string& name : names) properties[name] = number();
  return object(properties);
}

Json time() { return object({{"sec", integer()}, {"nsec", integer()}}); }
Json vector() { return numbers({"x", "y", "z"}); }
Json colour() { return numbers({"r", "g", "b", "a"}); }
Json pose() {
  return object({{"position", vector()}, {"orientation", numbers({"x", "y", "z", "w"})}});
}

Json entity() {
  const Json solid = object({{"pose", pose()}, {"size", vector()}, {"color", colour()}});
  const Json arrow = object({{"pose", pose()},
                             {"shaft_length", number()},
                             {"shaft_diameter", number()},
                             {"head_length", number()},
                             {"head_diameter", number()},
                             {"color", colour()}});
  const Json cylinder = object({{"pose", pose()},
                                {"size", vector()},
                                {"bottom_scale", number()},
                                {"top_scale", number()},
                                {"color", colour()}});
  const Json line = object({{"type", integer()},
                            {"pose", pose()},
                            {"thickness", number()},
                            {"scale_invariant", flag()},
                            {"points", list(vector())},
                            {"color", colour()},
                            {"colors", list(colour())},
                            {"indices", list(integer())}});
  const Json triangles = object({{"pose", pose()},
                                 {"points", list(vector())},
                                 {"color", colour()},
                                 {"colors", list(colour())},
                                 {"indices", list(integer())}});
  const Json label = object({{"pose", pose()},
                             {"billboard", flag()},
                             {"font_size", number()},
                             {"scale_invariant", flag()},
                             {"color", colour()},
                             {"text", text()}});
  const Json model = object({{"pose", pose()},
                             {"scale", vector()},
                             {"color", colour()},
                             {"override_color", flag()},
                             {"url", text()},
                             {"media_type", text()},
                             {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"id", text()},
                 {"lifetime", time()},
                 {"frame_locked", flag()},
                 {"metadata", list(object({{"key", text()}, {"value", text()}}))},
                 {"arrows", list(arrow)},
                 {"cubes", list(solid)},
                 {"spheres", list(solid)},
                 {"cylinders", list(cylinder)},
                 {"lines", list(line)},
                 {"triangles", list(triangles)},
                 {"texts", list(label)},
                 {"models", list(model)}});
}

Json named(const std::string& name, Json schema) {
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = name;
  return schema;
}

}  // namespace

nlohmann::ordered_json foxglove_schema(const std::string& name) {
  if (name == "foxglove.SceneUpdate") {
    const Json deletion = object({{"timestamp", time()}, {"type", integer()}, {"id", text()}});
    return named(name, object({{"deletions", list(deletion)}, {"entities", list(entity())}}));
  }
  if (name == "foxglove.PoseInFrame")
    return named(name, object({{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}}));
  if (name == "foxglove.FrameTransform")
    return named(name, object({{"timestamp", time()},
                               {"parent_frame_id", text()},
                               {"child_frame_id", text()},
                               {"translation", vector()},
                               {"rotation", numbers({"x", "y", "z", "w"})}}));
  if (name == "foxglove.PointCloud") {
    const Json field = object({{"name", text()}, {"offset", integer()}, {"type", integer()}});
    return named(name, object({{"timestamp", time()},
                               {"frame_id", text()},
                               {"pose", pose()},
                               {"point_stride", integer()},
                               {"fields", list(field)},
                               {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}}));
  }
  throw std::invalid_argument("no Foxglove schema " + name);
}

}  // namespace palpate::exporting
