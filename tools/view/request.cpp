#include "tools/view/request.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "rt/client/request.hpp"

namespace palpate::view {

using nlohmann::json;

namespace {

constexpr double kFarthest = 1e3;  // m
constexpr double kLongest = 1e9;   // s
constexpr double kSlowest = 0.01, kFastest = 100;

const json& entry(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw RequestError(std::string(key) + ": is missing");
  return *found;
}

double number(const json& value, const char* key, double lower, double upper) {
  const double x = value.is_number() ? value.get<double>() : std::nan("");
  if (!(x >= lower && x <= upper)) {
    char what[160];
    std::snprintf(what, sizeof(what), "%s: must be a number from %g to %g", key, lower, upper);
    throw RequestError(what);
  }
  return x;
}

std::string text(const json& object, const char* key, const std::string& otherwise) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return otherwise;
  if (!found->is_string()) throw RequestError(std::string(key) + ": must be a text");
  return found->get<std::string>();
}

std::vector<double> numbers(const json& object, const char* key, double most) {
  const json& list = entry(object, key);
  if (!list.is_array()) throw RequestError(std::string(key) + ": must be a list of numbers");
  std::vector<double> values;
  for (const json& value : list) values.push_back(number(value, key, -most, most));
  return values;
}

std::array<double, 3> vector3(const json& object, const char* key, double most) {
  const std::vector<double> values = numbers(object, key, most);
  if (values.size() != 3) throw RequestError(std::string(key) + ": must be three numbers");
  return {values[0], values[1], values[2]};
}

std::int64_t id_of(const json& object) {
  return static_cast<std::int64_t>(number(entry(object, "id"), "id", 0, 1e15));
}

Push read_push(const json& object, double max_force) {
  Push push{vector3(object, "point", kFarthest), vector3(object, "force", 1e6)};
  double norm = 0;
  for (const double f : push.force) norm = std::hypot(norm, f);
  if (norm > max_force)
    for (double& f : push.force) f *= max_force / norm;
  return push;
}

Play read_play(const json& object) {
  const std::string action = text(object, "action", "");
  if (action == "play") return {Play::Action::kPlay, 0};
  if (action == "pause") return {Play::Action::kPause, 0};
  if (action == "seek")
    return {Play::Action::kSeek, number(entry(object, "value"), "value", -kLongest, kLongest)};
  if (action == "rate")
    return {Play::Action::kRate, number(entry(object, "value"), "value", kSlowest, kFastest)};
  throw RequestError("action: must be play, pause, seek or rate");
}

Command read_command(const json& object) {
  const std::string event = text(object, "event", "");
  bool known = false;
  for (const char* name : {"start", "stop", "reset", "zero", "calibrate", "replace"})
    known = known || event == name;
  if (!known) throw RequestError("event: must be start, stop, reset, zero, calibrate or replace");
  return {id_of(object),
          client::make_command({event, text(object, "slot", "all"), text(object, "instance", ""),
                                text(object, "component", ""), text(object, "parameters", "")})};
}

Request read(const json& object, double max_force) {
  const std::string type = text(object, "type", "");
  if (type == "ack")
    return Acknowledge{static_cast<std::int64_t>(number(entry(object, "frame"), "frame", 0, 1e15))};
  if (type == "colour") {
    ColourBy colour{};
    if (!field_from(text(object, "field", ""), colour.field))
      throw RequestError("field: must be displacement, strain, stress or uncertainty");
    return colour;
  }
  if (type == "control") return TakeControl{text(object, "token", "")};
  if (type == "command") return read_command(object);
  if (type == "target")
    return SetTarget{id_of(object), client::make_target(text(object, "kind", ""), {},
                                                        numbers(object, "values", 1e6))};
  if (type == "push") return read_push(object, max_force);
  if (type == "play") return read_play(object);
  throw RequestError("type: must be ack, colour, control, command, target, push or play");
}

}  // namespace

bool moves_something(const Request& request) {
  return std::holds_alternative<Command>(request) || std::holds_alternative<SetTarget>(request) ||
         std::holds_alternative<Push>(request);
}

Request parse_request(const std::string& message, double max_force) {
  // Valid requests nest no deeper than a list in an object; the library's parser does not recurse.
  const json object = json::parse(message, nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw RequestError("not a JSON object");
  try {
    return read(object, max_force);
  } catch (const std::invalid_argument& error) {
    throw RequestError(error.what());
  }
}

}  // namespace palpate::view
