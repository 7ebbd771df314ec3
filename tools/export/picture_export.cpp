#include "tools/export/picture_export.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "sim/draw/image.hpp"
#include "tools/export/video.hpp"

namespace palpate::exporting {
namespace {

std::filesystem::path with_time(const std::filesystem::path& file, double time) {
  char text[32];
  std::snprintf(text, sizeof text, "_%07.3f", time);
  std::filesystem::path name = file;
  name.replace_filename(file.stem().string() + text + file.extension().string());
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
  bool is_told = false;
  follower.each("looking for shapes", [&](const Instant& instant) {
    // Recordings often end with shapes without ground truth: the last one that can be coloured.
    const bool tells_it = tells(instant, options.quantity);
    if (times.empty() && is_told && !tells_it) return;
    is_told = tells_it;
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
