#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::collect {

/// Presses of a hand that is reached over LCM, a real one or palpate-sim's.
struct HandProtocol {
  int finger = 0;  // BIOTAC_ of it
  int trials = 5;
  double force = 0.4;                        // N, that HOLD asks for, each finger
  double rest = 0.5, hold = 3, release = 1;  // s
};

struct HandCount {
  long touches = 0, wrenches = 0;  // messages recorded
};

/// Opens and closes the hand on what stands before its finger, trial by trial: publishes
/// HAND_COMMAND (OPEN, HOLD) and records BIOTAC_i and FT_WRENCH as they come, with a
/// COMPONENT_EVENT of each trial's begin, to an LCM event log that palpate-train reads. Knows
/// nothing but these channels. `name`: what the events say, as probe and area. Ends with OPEN, also
/// where it throws. Throws std::runtime_error where the log cannot be written or a trial brings
/// nothing of one of the channels, common::Interrupted.
/// `key`: that the hand's side is configured with, where it is.
HandCount collect_from_hand(bus::MessageBus& bus, const HandProtocol& protocol,
                            const std::string& name, const std::filesystem::path& log,
                            const std::optional<bus::Key>& key = {});

}  // namespace palpate::collect
