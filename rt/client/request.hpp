#pragma once

#include <palpate/component_command_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>
#include <vector>

namespace palpate::client {

/// A user's request to components of the daemon.
struct Request {
  std::string event;  // start, stop, reset, zero, calibrate, replace
  std::string slot = "all";
  std::string instance = {};
  std::string component = {};
  std::string parameters = {};  // YAML mapping
};

/// Throws std::invalid_argument if a text is too long for the message.
component_command_t make_command(const Request& request);

/// `points`: x, y, z of rest points in O, m; none: those configured for the feature. Returns the
/// chunks of the target, of revision 1. Throws std::invalid_argument for texts and lists that
/// messages cannot hold.
std::vector<shape_target_t> make_target(const std::string& kind, const std::vector<double>& points,
                                        const std::vector<double>& values);

/// A YAML mapping of "path.to.key=value" items, whose values are YAML. Throws
/// std::invalid_argument.
std::string make_parameters(const std::vector<std::string>& items);

}  // namespace palpate::client
