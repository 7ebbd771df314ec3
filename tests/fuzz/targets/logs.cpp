// Recordings of LCM, as the programs that score runs read them.

#include "tests/fuzz/target.hpp"
#include "tools/evaluate/log_reader.hpp"

namespace palpate::fuzz {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;

std::string big_endian(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = bytes; i-- > 0;) text += static_cast<char>(number >> 8 * i & 0xff);
  return text;
}

template <class Message>
std::string event(const std::string& channel, const Message& message, int number) {
  std::string data(message.getEncodedSize(), '\0');
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return big_endian(kSync, 4) + big_endian(number, 8) + big_endian(1000 * number, 8) +
         big_endian(channel.size(), 4) + big_endian(data.size(), 4) + channel + data;
}

}  // namespace

std::vector<std::string> seeds() {
  return {event("TWIST_COMMAND", twist_command_t{}, 0) + event("FEATURE", feature_t{}, 1),
          event("COMPONENT_EVENT", component_event_t{}, 0) +
              event("UNKNOWN", twist_command_t{}, 1) + event("TWIST_COMMAND", feature_t{}, 2) +
              event("ROBOT_STATE", robot_state_t{}, 3),
          event("SHAPE", shape_t{}, 0) + event("SHAPE_MESH", shape_mesh_t{}, 1) +
              event("TRUTH_SHAPE", shape_t{}, 2)};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const fuzz::MemoryFile file({reinterpret_cast<const char*>(data), size});
  try {
    const evaluate::RunLog run = evaluate::read_run(file.path(), file.path());
    fuzz::require(run.commands.size() * sizeof(std::int64_t) <= size, "no more than was recorded");
  } catch (const std::runtime_error& error) {
    fuzz::require(std::string(error.what()).find(file.path()) != std::string::npos,
                  "an error names its file");
  }
  return 0;
}
