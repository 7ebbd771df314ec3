#pragma once

#include <array>
#include <cstdint>
#include <palpate/component_command_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <stdexcept>
#include <string>
#include <variant>

#include "tools/view/field.hpp"

namespace palpate::view {

// Kinds of requests of a page.
struct Acknowledge {
  std::int64_t frame;  // that it has drawn
};
struct ColourBy {
  Field field;
};
struct TakeControl {
  std::string token;
};
struct Command {
  std::int64_t id;  // the page's own, to identify the answer
  component_command_t message;
};
struct SetTarget {
  std::int64_t id;
  std::vector<shape_target_t> message;  // its chunks
};
struct Push {
  std::array<double, 3> rest_point;  // m, in O
  std::array<double, 3> force;       // N, in O
};
struct Play {
  enum class Action { kPlay, kPause, kSeek, kRate } action;
  double value;  // s, or times real time
};
using Request = std::variant<Acknowledge, ColourBy, TakeControl, Command, SetTarget, Push, Play>;

/// Whether only a page that has presented the token may send it.
bool moves_something(const Request& request);

/// An invalid request; what() gives the reason, with the allowed range.
class RequestError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses a page's message, a JSON object with the entry "type". Throws RequestError. A force
/// beyond `max_force` N is limited to it.
Request parse_request(const std::string& text, double max_force);

}  // namespace palpate::view
