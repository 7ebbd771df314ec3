#include "tools/export/log_export.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "tools/common/progress.hpp"
#include "tools/export/source.hpp"
#include "tools/log/event_log.hpp"
#include "tools/log/merged_log.hpp"

namespace palpate::exporting {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kShowEvery = 20'000;  // events

/// Remembers which patterns fitted a channel of the logs.
class ChannelSelection {
 public:
  explicit ChannelSelection(const LogSelection& selection) : selection_(selection) {}

  bool selects(const std::string& channel) {
    const auto [found, is_new] = known_.try_emplace(channel, true);
    if (!is_new) return found->second;
    const bool is_in = selection_.channels.empty() || fits_one(selection_.channels, channel);
    const bool is_out = fits_one(selection_.without, channel);
    return found->second = is_in && !is_out;
  }

  /// Throws std::runtime_error for a pattern that fitted none.
  void require_all_used() const {
    for (const auto* patterns : {&selection_.channels, &selection_.without})
      for (const std::string& pattern : *patterns) {
        if (used_.count(pattern) > 0) continue;
        std::string names;
        for (const auto& [channel, selected] : known_)
          names += (names.empty() ? "" : ", ") + channel;
        throw std::runtime_error("no channel '" + pattern + "' in the logs; they have: " + names);
      }
  }

 private:
  bool fits_one(const std::vector<std::string>& patterns, const std::string& channel) {
    bool any = false;
    for (const std::string& pattern : patterns) {
      if (!fits(pattern, channel)) continue;
      used_.insert(pattern);
      any = true;
    }
    return any;
  }

  const LogSelection& selection_;
  std::map<std::string, bool> known_;
  std::set<std::string> used_;
};

}  // namespace

Written export_log(const LogSelection& selection, const fs::path& output) {
  for (const fs::path& log : selection.logs)
    if (fs::exists(output) && fs::equivalent(log, output))
      throw std::runtime_error(output.string() + ": is one of the logs that are read");
  log::MergedLog logs(selection.logs);
  if (output.has_parent_path()) fs::create_directories(output.parent_path());
  const fs::path part = output.string() + ".part";
  std::optional<common::Progress> progress;
  if (!selection.quiet) progress.emplace(1, 1, "writing " + output.filename().string());
  ChannelSelection channels(selection);
  std::int64_t events = 0, written = 0, begin = 0;
  try {
    log::EventLog file(part);
    std::vector<std::uint8_t> data;
    while (const bus::LoggedEvent* event = logs.next()) {
      if (events == 0) begin = event->utime;
      if (progress && events % kShowEvery == 0)
        progress->show(static_cast<double>(logs.place()) / static_cast<double>(logs.size()), "");
      ++events;
      const double time = 1e-6 * static_cast<double>(event->utime - begin);
      if (!channels.selects(event->channel) || time < selection.from || time > selection.to)
        continue;
      data.assign(event->data, event->data + event->size);
      file.write(event->channel, event->utime, data);
      ++written;
    }
    channels.require_all_used();
    if (written == 0) throw std::runtime_error("no event of the logs is selected");
  } catch (...) {
    fs::remove(part);
    throw;
  }
  fs::rename(part, output);
  if (progress) progress->finish(true, "");
  for (const std::string& complaint : logs.complaints())
    std::cerr << "warning: " << complaint << std::endl;
  return {output, "of " + std::to_string(events) + " events", written};
}

}  // namespace palpate::exporting
