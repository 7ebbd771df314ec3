#include "tools/view/log_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/bus/event_log_reader.hpp"
#include "rt/bus/text.hpp"

namespace palpate::view {
namespace {

// Interval between indexed messages of one channel; events and meshes are all indexed.
constexpr std::int64_t kClosest = 4'000;  // us
constexpr std::size_t kSeriesPoints = 1'500;

/// us, clock of the sender: the first field of every message; 0 if the message is too short.
std::int64_t sent_us(const std::uint8_t* data, int size) {
  std::uint64_t big_endian = 0;
  if (size >= 16) std::memcpy(&big_endian, data + 8, sizeof(big_endian));
  return static_cast<std::int64_t>(__builtin_bswap64(big_endian));
}

bool is_shape(const std::string& channel) {
  return channel == channel::kShape || channel == channel::kTruthShape;
}

/// Messages of which the newest is shown: those of a channel, or, of obstacles, of one of them:
/// "WORLD_STATE NAME". A seek to any time finds the place of each obstacle.
std::string track_of(const bus::LoggedEvent& event) {
  world_state_t message;
  if (event.channel != channel::kWorldState || !bus::decode(message, event.data, event.size))
    return event.channel;
  return event.channel + " " + bus::get_text(message.name);
}

std::string channel_of(const std::string& track) { return track.substr(0, track.find(' ')); }

bool keeps_all(const std::string& channel) {
  return channel == Scene::kEvents || Scene::is_mesh(channel);
}

/// At most kSeriesPoints, each the maximum of its interval, so that no peak is lost.
void thin(Series& series) {
  const std::size_t n = series.value.size();
  if (n <= kSeriesPoints) return;
  Series thinned{series.name, series.unit, {}, {}};
  for (std::size_t i = 0; i < kSeriesPoints; ++i) {
    const std::size_t first = i * n / kSeriesPoints, last = (i + 1) * n / kSeriesPoints;
    const auto largest = std::max_element(series.value.begin() + static_cast<std::ptrdiff_t>(first),
                                          series.value.begin() + static_cast<std::ptrdiff_t>(last));
    thinned.time_s.push_back(
        series.time_s[static_cast<std::size_t>(largest - series.value.begin())]);
    thinned.value.push_back(*largest);
  }
  series = std::move(thinned);
}

}  // namespace

LogSource::LogSource(const std::vector<std::string>& files, const Progress& progress,
                     std::vector<std::string>& complaints, const types::TypeSet& described,
                     const bus::ChannelNames& names)
    : names_(names) {
  for (std::size_t i = 0; i < files.size(); ++i)
    index(files[i], static_cast<std::int16_t>(i), progress, complaints, described);
  std::int64_t end_us = 0;
  begin_us_ = bus::kLatestEventTime;
  for (auto& [track, list] : entries_) {
    std::stable_sort(list.begin(), list.end(),
                     [](const Entry& a, const Entry& b) { return a.time_us < b.time_us; });
    begin_us_ = std::min(begin_us_, list.front().time_us);
    end_us = std::max(end_us, list.back().time_us);
  }
  if (entries_.empty())
    throw std::runtime_error(files.front() +
                             ": holds no message to be shown; name the logs of both URLs, as "
                             "--log control.log housekeeping.log");
  duration_ = static_cast<double>(end_us - begin_us_) * 1e-6;
  finish_series();
}

void LogSource::index(const std::string& path, std::int16_t number, const Progress& progress,
                      std::vector<std::string>& complaints, const types::TypeSet& described) {
  bus::EventLogReader reader(path);
  files_.emplace_back(path, std::ios::binary);
  const auto size = static_cast<double>(std::filesystem::file_size(path));
  const auto& wanted = Scene::channels();
  double reported = 0;
  bus::LoggedEvent renamed;
  while (const bus::LoggedEvent* event = reader.next()) {
    const std::size_t name_size = event->channel.size();
    if (!names_.empty()) {
      renamed = *event;
      renamed.channel = bus::own_name(names_, event->channel);
      event = &renamed;
    }
    const double share = size > 0 ? static_cast<double>(event->at) / size : 1;
    if (share - reported >= 0.01) progress(path, reported = share);
    if (std::find(wanted.begin(), wanted.end(), event->channel) == wanted.end() &&
        described.type_of(event->data, event->size) == nullptr)
      continue;
    note(event->channel, event->data, event->size, event->utime);
    std::vector<Entry>& list = entries_[track_of(*event)];
    const std::int64_t sent = sent_us(event->data, event->size);
    const bool is_next_chunk =
        is_shape(event->channel) && !list.empty() && list.back().sent_us == sent;
    if (!keeps_all(event->channel) && !list.empty() && !is_next_chunk) {
      const std::int64_t since = event->utime - list.back().time_us;
      if (since >= 0 && since < kClosest) continue;
    }
    const std::int64_t at =
        event->at + bus::kEventHeaderSize + static_cast<std::int64_t>(name_size);
    list.push_back({event->utime, at, sent, event->size, number});
  }
  if (!reader.complaint().empty()) complaints.push_back(reader.complaint());
}

void LogSource::note(const std::string& channel, const void* data, int size, std::int64_t time_us) {
  const auto add = [&](std::size_t which, double value) {
    if (std::isfinite(value)) noted_[which].push_back({time_us, static_cast<float>(value)});
  };
  if (channel == channel::kFeature) {
    feature_t feature;
    if (bus::decode(feature, data, size) && feature.error_count >= 1 && feature.error_count <= 32)
      add(0, error_norm(feature));
  } else if (channel == channel::kHealth) {
    health_t health;
    if (!bus::decode(health, data, size) || health.phase_count != kPhases) return;
    add(1, static_cast<double>(health.p99_us[0]));
    add(2, static_cast<double>(health.p99_us[kPhases - 1]));
  } else if (channel == channel::kDiscrepancy) {
    discrepancy_t test;
    if (!bus::decode(test, data, size) || !(test.test >= 0)) return;
    add(3, test.test);
    add(4, test.threshold);
    if (test.inconsistent != 0) add(5, test.test);
  } else if (channel == Scene::kEvents) {
    component_event_t event;
    if (bus::decode(event, data, size)) happened_.emplace_back(time_us, bus::get_text(event.event));
  }
}

void LogSource::finish_series() {
  const char* const kSeriesNames[][2] = {{"feature error", ""}, {"cycle", "us"},
                                         {"wake-up", "us"},     {"wrench test", ""},
                                         {"threshold", ""},     {"contradiction", ""}};
  const auto seconds = [this](std::int64_t time_us) {
    return static_cast<double>(time_us - begin_us_) * 1e-6;
  };
  for (std::size_t i = 0; i < noted_.size(); ++i) {
    std::stable_sort(noted_[i].begin(), noted_[i].end(),
                     [](const Noted& a, const Noted& b) { return a.time_us < b.time_us; });
    Series series{kSeriesNames[i][0], kSeriesNames[i][1], {}, {}};
    for (const Noted& noted : noted_[i]) {
      series.time_s.push_back(static_cast<float>(seconds(noted.time_us)));
      series.value.push_back(noted.value);
    }
    noted_[i] = {};
    thin(series);
    series_.push_back(std::move(series));
  }
  for (const auto& [time_us, what] : happened_) marks_.emplace_back(seconds(time_us), what);
}

void LogSource::offer(const std::string& track, const Entry& entry, Scene& scene) {
  buffer_.resize(static_cast<std::size_t>(entry.size));
  std::ifstream& file = files_[static_cast<std::size_t>(entry.file)];
  file.clear();
  file.seekg(entry.at);
  if (file.read(reinterpret_cast<char*>(buffer_.data()), entry.size))
    scene.accept(channel_of(track), buffer_.data(), entry.size, entry.time_us);
}

void LogSource::go_to(double time, Scene& scene) {
  time = std::clamp(std::isfinite(time) ? time : 0.0, 0.0, duration_);
  const std::int64_t now_us = begin_us_ + static_cast<std::int64_t>(std::llround(time * 1e6));
  const bool all_meshes = time_ < 0;
  if (time < time_) {
    scene.forget_messages();
    shown_.clear();
  }
  time_ = time;
  for (const auto& [track, list] : entries_) {
    const auto end = std::upper_bound(
        list.begin(), list.end(), now_us,
        [](std::int64_t limit, const Entry& entry) { return limit < entry.time_us; });
    const auto count = static_cast<std::size_t>(end - list.begin());
    std::size_t& shown = shown_[track];
    if (track == Scene::kEvents) {
      const std::size_t most = Scene::kMostEvents;
      for (std::size_t i = std::max(shown, count > most ? count - most : 0); i < count; ++i)
        offer(track, list[i], scene);
    } else if (keeps_all(track)) {
      // A mesh applies to the whole log, though its chunks may come after the first shape.
      if (all_meshes)
        for (const Entry& entry : list) offer(track, entry, scene);
    } else if (count > shown) {
      std::size_t first = count - 1;  // or the first chunk of a shape
      while (is_shape(track) && first > 0 && list[first - 1].sent_us == list[first].sent_us)
        --first;
      for (std::size_t i = first; i < count; ++i) offer(track, list[i], scene);
    }
    shown = count;
  }
}

}  // namespace palpate::view
