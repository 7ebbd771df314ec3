#include "sim/scenes/run_recorder.hpp"

#include <stdexcept>

namespace palpate::scenes {
namespace {

std::filesystem::path created(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

RunRecorder::RunRecorder(const std::filesystem::path& folder, bool has_clouds)
    : sensors_(created(folder) / "sensors.log"),
      truth_(folder / "truth.log"),
      clouds_(has_clouds ? std::make_unique<File>(folder / "clouds.log") : nullptr) {}

void RunRecorder::write(std::int64_t utime) {
  sensors_.write(utime);
  truth_.write(utime);
}

void RunRecorder::write_cloud(const std::string& channel, const std::vector<std::uint8_t>& message,
                              std::int64_t utime) {
  if (clouds_) clouds_->write(utime, channel, message);
}

RunRecorder::File::File(const std::filesystem::path& to) : path(to), file(to.string(), "w") {
  if (!file.good()) throw std::runtime_error(path.string() + ": cannot be written");
}

void RunRecorder::File::write(std::int64_t utime, const std::string& channel,
                              const std::vector<std::uint8_t>& message) {
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.data = const_cast<std::uint8_t*>(message.data());  // only read
  event.datalen = static_cast<int>(message.size());
  if (file.writeEvent(&event) != 0)
    throw std::runtime_error(path.string() + ": cannot be written further");
}

RunRecorder::Log::Log(const std::filesystem::path& to) : file(to) { bus::record(*hub, &published); }

void RunRecorder::Log::write(std::int64_t utime) {
  for (const bus::Published& message : published) file.write(utime, message.channel, message.data);
  published.clear();
}

}  // namespace palpate::scenes
