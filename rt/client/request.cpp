#include "rt/client/request.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>

#include "rt/bus/text.hpp"

namespace palpate::client {
namespace {

template <std::size_t kSize>
void put(std::uint8_t (&field)[kSize], const char* name, const std::string& text) {
  if (text.size() >= kSize)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(text.size()) +
                                " bytes; at most " + std::to_string(kSize - 1) + " fit a message");
  bus::put_text(field, text);
}

/// Sets `value` at `path` in `node`.
YAML::Node with(const YAML::Node& node, const std::string& path, const YAML::Node& value) {
  const std::size_t dot = path.find('.');
  const std::string key = path.substr(0, dot);
  YAML::Node changed = YAML::Clone(node);
  if (dot == std::string::npos) {
    changed[key] = value;
  } else {
    const YAML::Node below = node[key];
    changed[key] = with(below && below.IsMap() ? below : YAML::Node(YAML::NodeType::Map),
                        path.substr(dot + 1), value);
  }
  return changed;
}

}  // namespace

component_command_t make_command(const Request& request) {
  component_command_t message{};
  put(message.event, "event", request.event);
  put(message.slot, "slot", request.slot);
  put(message.instance, "instance", request.instance);
  put(message.component, "component", request.component);
  put(message.parameters, "parameters", request.parameters);
  return message;
}

std::vector<shape_target_t> make_target(const std::string& kind, const std::vector<double>& points,
                                        const std::vector<double>& values) {
  constexpr std::size_t kPoints = 64, kValues = 192, kMostChunks = 8;  // shape_target_t
  const std::size_t point_count = points.size() / 3;
  if (points.size() % 3 != 0 || point_count > kMostChunks * kPoints)
    throw std::invalid_argument("points: x, y and z of at most 512");
  if (values.size() > kMostChunks * kValues)
    throw std::invalid_argument("values: at most 1536 numbers");
  const std::size_t by_points = (point_count + kPoints - 1) / kPoints,
                    by_values = (values.size() + kValues - 1) / kValues;
  const std::size_t chunks = std::max<std::size_t>(1, std::max(by_points, by_values));
  if (chunks > 1 && point_count > 0 && by_points != by_values)
    throw std::invalid_argument("values: three for each of more than 64 points");
  std::vector<shape_target_t> messages(chunks);
  for (std::size_t c = 0; c < chunks; ++c) {
    shape_target_t& message = messages[c];
    message = {};
    message.revision = 1;
    message.chunk = static_cast<std::int16_t>(c);
    message.chunks = static_cast<std::int16_t>(chunks);
    put(message.kind, "kind", kind);
    const std::size_t first = std::min(c * kPoints, point_count),
                      end = std::min(first + kPoints, point_count);
    message.point_count = static_cast<int>(end - first);
    std::copy(points.data() + 3 * first, points.data() + 3 * end, &message.rest_points[0][0]);
    const std::size_t begin = std::min(c * kValues, values.size()),
                      behind = std::min(begin + kValues, values.size());
    message.value_count = static_cast<int>(behind - begin);
    std::copy(values.data() + begin, values.data() + behind, message.values);
  }
  return messages;
}

std::string make_parameters(const std::vector<std::string>& items) {
  YAML::Node whole(YAML::NodeType::Map);
  for (const std::string& item : items) {
    const std::size_t equals = item.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw std::invalid_argument("\"" + item + "\" is not key=value");
    try {
      whole = with(whole, item.substr(0, equals), YAML::Load(item.substr(equals + 1)));
    } catch (const YAML::Exception& error) {
      throw std::invalid_argument("\"" + item + "\": " + error.what());
    }
  }
  if (items.empty()) return "";
  YAML::Emitter text;
  text << YAML::Flow << whole;
  return text.c_str();
}

}  // namespace palpate::client
