#include "sim/scenes/run_recorder.hpp"

#include <stdexcept>

namespace palpate::scenes {
namespace {

std::filesystem::path created(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

RunRecorder::RunRecorder(const std::filesystem::path& folder)
    : sensors_(created(folder) / "sensors.log"), truth_(folder / "truth.log") {}

void RunRecorder::write(std::int64_t utime) {
  sensors_.write(utime);
  truth_.write(utime);
}

RunRecorder::Log::Log(const std::filesystem::path& to) : path(to), file(to.string(), "w") {
  if (!file.good()) throw std::runtime_error(path.string() + ": cannot be written");
  bus::record(*hub, &published);
}

void RunRecorder::Log::write(std::int64_t utime) {
  for (bus::Published& message : published) {
    lcm::LogEvent event{};
    event.timestamp = utime;
    event.channel = std::move(message.channel);
    event.data = message.data.data();
    event.datalen = static_cast<int>(message.data.size());
    if (file.writeEvent(&event) != 0)
      throw std::runtime_error(path.string() + ": cannot be written further");
  }
  published.clear();
}

}  // namespace palpate::scenes
