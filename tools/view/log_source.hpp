#pragma once

#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/view/scene.hpp"

namespace palpate::view {

/// A value over a log's time, decimated so that a plot of it stays fast.
struct Series {
  std::string name, unit;
  std::vector<float> time_s, value;
};

/// Plays LCM logs of one run (one file per URL) into a scene: seeks to any time, plays forwards at
/// any rate, and backwards. Files are read once for an index and then piece by piece.
class LogSource {
 public:
  using Progress = std::function<void(const std::string& file, double share)>;

  /// Throws std::runtime_error naming the file if one cannot be read, is not a log, or if none
  /// holds a message to show. `complaints`: one line for each damaged file. `described`: types of
  /// further messages to be shown; those of the scene. `names`: that channels had on the buses.
  LogSource(const std::vector<std::string>& files, const Progress& progress,
            std::vector<std::string>& complaints, const types::TypeSet& described = {},
            const bus::ChannelNames& names = {});

  double duration() const { return duration_; }  // s
  double time() const { return time_; }          // s since the log's start
  std::int64_t begin_us() const { return begin_us_; }

  /// Sets the scene to `time`, s, limited to the log.
  void go_to(double time, Scene& scene);

  /// Of the whole log: feature error, latency, lateness, and the wrenches' test with its threshold
  /// and, while they are inconsistent, the test again.
  const std::vector<Series>& series() const { return series_; }
  /// Time, s, and description of each event. For marks on the timeline.
  const std::vector<std::pair<double, std::string>>& marks() const { return marks_; }

 private:
  struct Entry {
    std::int64_t time_us;
    std::int64_t at;       // of the data in the file
    std::int64_t sent_us;  // clock of the sender; equal for all chunks of a shape
    std::int32_t size;
    std::int16_t file;
  };
  void index(const std::string& path, std::int16_t number, const Progress& progress,
             std::vector<std::string>& complaints, const types::TypeSet& described);
  void offer(const std::string& track, const Entry& entry, Scene& scene);
  void note(const std::string& channel, const void* data, int size, std::int64_t time_us);
  void finish_series();

  struct Noted {
    std::int64_t time_us;
    float value;
  };

  bus::ChannelNames names_;
  std::vector<std::ifstream> files_;
  // By track, which is a channel or, of WORLD_STATE, an obstacle's part of it; in order of time.
  std::map<std::string, std::vector<Entry>> entries_;
  std::map<std::string, std::size_t> shown_;  // number of each track's messages passed to the scene
  std::vector<std::uint8_t> buffer_;
  std::array<std::vector<Noted>, 6> noted_;  // until all files are read
  std::vector<std::pair<std::int64_t, std::string>> happened_;
  std::vector<Series> series_;
  std::vector<std::pair<double, std::string>> marks_;
  std::int64_t begin_us_ = 0;
  double duration_ = 0, time_ = -1;
};

}  // namespace palpate::view
