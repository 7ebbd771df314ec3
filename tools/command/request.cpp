#include "tools/command/request.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>

#include "rt/daemon/text.hpp"

namespace palpate::command {
namespace {

template <std::size_t kSize>
void put(std::uint8_t (&field)[kSize], const char* name, const std::string& text) {
  if (text.size() >= kSize)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(text.size()) +
                                " bytes; at most " + std::to_string(kSize - 1) + " fit a message");
  daemon::put_text(field, text);
}

template <std::size_t kSize>
int put(double (&field)[kSize], const char* name, const std::vector<double>& numbers) {
  if (numbers.size() > kSize)
    throw std::invalid_argument(std::string(name) + ": at most " + std::to_string(kSize) +
                                " numbers fit a message");
  std::copy(numbers.begin(), numbers.end(), field);
  return static_cast<int>(numbers.size());
}

/// `node` with `value` at `path` below it.
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

shape_target_t make_target(const std::string& kind, const std::vector<double>& points,
                           const std::vector<double>& values) {
  constexpr std::size_t kMostPoints = 64;
  shape_target_t message{};
  message.revision = 1;
  message.chunks = 1;
  put(message.kind, "kind", kind);
  if (points.size() % 3 != 0 || points.size() / 3 > kMostPoints)
    throw std::invalid_argument("points: x, y and z of at most 64");
  message.point_count = static_cast<int>(points.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) message.rest_points[i / 3][i % 3] = points[i];
  message.value_count = put(message.values, "values", values);
  return message;
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

}  // namespace palpate::command
