#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::collect {

/// Presses by a hand reached over LCM, real or simulated by palpate-sim.
struct HandProtocol {
  int finger = 0;  // BIOTAC_ of it
  int trials = 5;
  double force = 0.4;                        // N, for HOLD, per finger
  double rest = 0.5, hold = 3, release = 1;  // s
};

struct HandCount {
  long touches = 0, wrenches = 0;  // messages recorded
};

/// Opens and closes the hand on an object in front of its finger, trial by trial: publishes
/// HAND_COMMAND (OPEN, HOLD) and records BIOTAC_i and FT_WRENCH as they arrive, with a
/// COMPONENT_EVENT at each trial's start, to an LCM event log that palpate-train reads. Uses only
/// these channels. `name`: probe and area in the events. Ends with OPEN, also when it throws.
/// Throws std::runtime_error if the log cannot be written or one of the channels is silent during a
/// trial, evaluate::Interrupted. `key`: the one configured on the hand's side, if any.
HandCount collect_from_hand(bus::MessageBus& bus, const HandProtocol& protocol,
                            const std::string& name, const std::filesystem::path& log,
                            const std::optional<bus::Key>& key = {});

}  // namespace palpate::collect
