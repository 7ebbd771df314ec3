#include "tools/export/picture_export.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/draw/image.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"

namespace palpate::exporting {
namespace {

/// A video encoded by Debian's ffmpeg (H.264, yuv420p, for the widest compatibility) from images
/// piped to it.
class Video {
 public:
  /// Throws std::runtime_error if ffmpeg is not installed or does not start, or the name does not
  /// end in .mp4; std::invalid_argument if width or height is odd, which H.264 does not support.
  Video(const std::filesystem::path& file, int width, int height, double rate)
      : file_(file), part_(file), messages_(file), width_(width), height_(height) {
    if (file.extension() != ".mp4")
      throw std::runtime_error(file.string() + ": the name of a film must end in .mp4");
    if (width % 2 != 0 || height % 2 != 0)
      throw std::invalid_argument("width and height of a film must be even");
    if (!common::is_installed("ffmpeg"))
      throw std::runtime_error("ffmpeg cannot be run (apt-get install ffmpeg)");
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
    part_.replace_extension(".part.mp4");
    messages_.replace_extension(".ffmpeg-messages");
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to ffmpeg can be made");
    pipe_ = fdopen(ends[1], "wb");
    signal(SIGPIPE, SIG_IGN);  // if ffmpeg has ended, the write fails
    const std::vector<std::string> command{
        "ffmpeg",     "-y",
        "-loglevel",  "error",
        "-f",         "rawvideo",
        "-pix_fmt",   "rgb24",
        "-s",         std::to_string(width) + "x" + std::to_string(height),
        "-r",         std::to_string(rate),
        "-i",         "pipe:0",
        "-an",        "-c:v",
        "libx264",    "-preset",
        "medium",     "-crf",
        "20",         "-pix_fmt",
        "yuv420p",    "-movflags",
        "+faststart", part_.string()};
    process_.emplace("ffmpeg", command, messages_, ends[0]);
    close(ends[0]);
  }
  ~Video() {
    if (pipe_ == nullptr) return;
    fclose(pipe_);
    process_.reset();
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
    std::filesystem::remove(messages_, ignored);
  }
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(const draw::Image& image) {
    if (image.width != width_ || image.height != height_)
      throw std::invalid_argument("a picture of another size than the film's");
    if (fwrite(image.rgb.data(), 1, image.rgb.size(), pipe_) != image.rgb.size()) fail();
  }

  /// Waits for ffmpeg; throws std::runtime_error with its last output if it failed.
  void finish() {
    constexpr double kLongest = 1e8;  // s; a film may take any time
    const bool is_flushed = fclose(std::exchange(pipe_, nullptr)) == 0;
    if (process_->wait(kLongest) != 0 || !is_flushed) fail();
    std::filesystem::remove(messages_);
    std::filesystem::rename(part_, file_);
  }

 private:
  [[noreturn]] void fail() const {
    throw std::runtime_error(file_.string() + ": ffmpeg failed: " + common::tail(messages_, 5));
  }

  std::filesystem::path file_, part_, messages_;
  int width_, height_;
  FILE* pipe_ = nullptr;
  std::optional<common::Process> process_;
};

std::filesystem::path with_time(const std::filesystem::path& file, double time) {
  std::filesystem::path name = file;
  name.replace_filename(file.stem().string() + common::formatted("_%07.3f", time) +
                        file.extension().string());
  return name;
}

}  // namespace

std::vector<Written> export_png(ShapeFollower& follower, const DrawingOptions& options,
                                std::vector<double> times, const std::filesystem::path& file) {
  if (file.extension() != ".png")
    throw std::runtime_error(file.string() + ": the name of a picture must end in .png");
  std::sort(times.begin(), times.end());
  std::vector<Instant> shown;
  std::size_t next = 0;
  std::optional<Instant> held;
  bool has_held = false;
  follower.each("looking for shapes", [&](const Instant& instant) {
    // Recordings often end with shapes without ground truth: the last one that can be coloured.
    const bool has_it = has_quantity(instant, options.quantity);
    if (times.empty() && has_held && !has_it) return;
    has_held = has_it;
    for (; next < times.size() && times[next] < instant.time; ++next)
      if (held) shown.push_back(*held);
    held = instant;
  });
  if (!held) throw std::runtime_error("no shape lies in the times that were asked for");
  if (times.empty() || next < times.size()) shown.push_back(*held);
  if (!times.empty() && next == 0 && shown.empty())
    throw std::runtime_error("no shape was there yet at the times asked for");

  SceneDrawing drawing(options);
  for (const Instant& instant : shown) drawing.measure(instant);
  drawing.check();
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::vector<Written> written;
  for (const Instant& instant : shown) {
    const auto name = times.size() > 1 ? with_time(file, instant.time) : file;
    draw::write_png(name.string(), drawing.draw(instant));
    written.push_back({name, "shape at " + std::to_string(instant.time) + " s", 1});
  }
  return written;
}

std::vector<Written> export_mp4(ShapeFollower& follower, const DrawingOptions& options,
                                const FilmOptions& film, const std::filesystem::path& file) {
  SceneDrawing drawing(options);
  const double rate = film.rate / film.speed;
  follower.sample("measuring", rate, [&](const Instant& instant) { drawing.measure(instant); });
  drawing.check();
  Video video(file, options.width, options.height, film.rate);
  std::int64_t count = 0;
  follower.sample("drawing", rate, [&](const Instant& instant) {
    video.add(drawing.draw(instant));
    ++count;
  });
  video.finish();
  return {{file, "pictures", count}};
}

}  // namespace palpate::exporting
