// LCM recordings: every event of one, as read by the scoring programs.

#include <iostream>

#include "rt/bus/event_log_reader.hpp"
#include "rt/bus/log_ring.hpp"
#include "rt/bus/message_bus.hpp"
#include "tests/fuzz/target.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::fuzz {
namespace {

template <class Message>
void add(bus::LogRing& log, const std::string& channel, const Message& message) {
  std::vector<std::uint8_t> data(message.getEncodedSize());
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  log.add(1000, channel, data.data(), static_cast<int>(data.size()));
}

std::string bytes_of(const bus::LogRing& log) {
  const bus::LogRing::Piece all = log.pieces()[0];
  return {reinterpret_cast<const char*>(all.data), all.size};
}

}  // namespace

std::vector<std::string> seeds() {
  constexpr std::size_t kRoom = 10'000;
  bus::LogRing control(kRoom, 1), strange(kRoom, 1), housekeeping(kRoom, 1);
  add(control, "TWIST_COMMAND", twist_command_t{});
  add(control, "FEATURE", feature_t{});
  add(strange, "COMPONENT_EVENT", component_event_t{});
  add(strange, "UNKNOWN", twist_command_t{});
  add(strange, "TWIST_COMMAND", feature_t{});
  add(strange, "ROBOT_STATE", robot_state_t{});
  add(housekeeping, "SHAPE", shape_t{});
  add(housekeeping, "SHAPE_MESH", shape_mesh_t{});
  add(housekeeping, "TRUTH_SHAPE", shape_t{});
  return {bytes_of(control), bytes_of(strange), bytes_of(housekeeping)};
}

/// Each byte of the file belongs to one event, or is counted as damage or as the truncated last
/// event.
void check_events(const std::string& path, std::int64_t size) {
  bus::EventLogReader log(path);
  std::int64_t read = 0, end = 0;
  while (const bus::LoggedEvent* event = log.next()) {
    require(event->at >= end, "events follow each other");
    require(event->utime >= 0 && event->utime <= bus::kLatestEventTime, "a possible time");
    require(!event->channel.empty() && event->channel.size() <= bus::kLongestChannel, "a channel");
    const auto whole =
        static_cast<std::int64_t>(bus::kEventHeaderSize + event->channel.size()) + event->size;
    end = event->at + whole;
    read += whole;
    require(end <= size, "events are in the file");
  }
  const std::int64_t left = size - read - log.damage().skipped;
  require(log.damage().cut_short ? left > 0 : left == 0, "no byte is forgotten");
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const bool is_quiet = std::cerr.rdbuf(nullptr) != nullptr;  // of warnings
  (void)is_quiet;
  const fuzz::MemoryFile file({reinterpret_cast<const char*>(data), size});
  try {
    fuzz::check_events(file.path(), static_cast<std::int64_t>(size));
    const log::RunLog run = log::read_run(file.path(), file.path());
    fuzz::require(run.commands.size() * sizeof(std::int64_t) <= size, "no more than was recorded");
  } catch (const std::runtime_error& error) {
    fuzz::require(std::string(error.what()).find(file.path()) != std::string::npos,
                  "an error names its file");
  }
  return 0;
}
