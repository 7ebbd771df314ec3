#include "tools/export/source.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"

namespace palpate::exporting {
namespace {

constexpr std::int64_t kReportEvery = 20'000;  // events

std::string size_text(std::int64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e6   ? common::formatted("%.0f kB", 1e-3 * size)
         : size < 1e9 ? common::formatted("%.1f MB", 1e-6 * size)
                      : common::formatted("%.2f GB", 1e-9 * size);
}

/// Header of every message of our types, after the fingerprint.
struct Head {
  std::int64_t utime = 0, session = 0;
};

/// Empty for an unknown type or a message that is too short.
std::optional<Head> head_of(const bus::LoggedEvent& event) {
  constexpr int kUtimeAt = 8, kSessionAt = 20, kEnd = 28;
  const auto number = [&event](int at) {
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) value = value << 8 | event.data[at + i];
    return static_cast<std::int64_t>(value);
  };
  if (event.size < kEnd || log::type_of(event.data, event.size) == nullptr) return std::nullopt;
  return Head{number(kUtimeAt), number(kSessionAt)};
}

/// A progress stage on standard error, or none.
class Stage {
 public:
  Stage(bool quiet, const std::string& title, std::int64_t bytes) : bytes_(bytes) {
    if (!quiet) progress_.emplace(1, 1, title);
  }
  void show(double part) {
    if (progress_)
      progress_->show(
          part, size_text(static_cast<std::int64_t>(part * static_cast<double>(bytes_))) + " of " +
                    size_text(bytes_));
  }
  void finish() {
    if (progress_) progress_->finish(true, size_text(bytes_));
  }

 private:
  std::int64_t bytes_;
  std::optional<common::Progress> progress_;
};

}  // namespace

bool fits(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

Source::Source(const SourceOptions& options)
    : options_(options), types_(options.types), log_(options.logs) {
  Stage stage(options_.quiet, "looking through the log", log_.size());
  survey_ = survey(
      log_, [&stage](double part) { stage.show(part); }, types_);
  stage.finish();
  for (const std::string& complaint : survey_.complaints)
    std::cerr << "warning: " << complaint << std::endl;
  for (const std::string& pattern : options_.channels) {
    if (std::any_of(survey_.channels.begin(), survey_.channels.end(),
                    [&pattern](const ChannelSurvey& c) { return fits(pattern, c.channel); }))
      continue;
    std::string names;
    for (const ChannelSurvey& channel : survey_.channels)
      names += (names.empty() ? "" : ", ") + channel.channel;
    throw std::runtime_error("no channel '" + pattern + "' in the log; it has: " + names);
  }
}

bool Source::is_selected(const ChannelSurvey& channel) const {
  return channel.type != nullptr && matches(channel);
}

bool Source::is_foreign_selected(const ChannelSurvey& channel) const {
  return channel.foreign != nullptr && matches(channel);
}

bool Source::matches(const ChannelSurvey& channel) const {
  if (options_.channels.empty()) return true;
  return std::any_of(
      options_.channels.begin(), options_.channels.end(),
      [&channel](const std::string& pattern) { return fits(pattern, channel.channel); });
}

std::int64_t Source::origin() const {
  return options_.clock == Clock::kReceived ? survey_.received.first : survey_.sent.first;
}

void Source::each(const std::string& title, const std::function<void(const Message&)>& take,
                  const std::function<void(const ForeignMessage&)>& take_foreign) {
  read(
      title, [this](const ChannelSurvey& channel) { return is_selected(channel); },
      [this, &take](const Message& message) {
        if (is_in_time(message.time)) take(message);
      },
      take_foreign);
}

void Source::each_of(const std::string& title, const std::vector<std::string>& channels,
                     const std::function<void(const Message&)>& take) {
  const auto wanted = [&channels](const ChannelSurvey& entry) {
    return std::find(channels.begin(), channels.end(), entry.channel) != channels.end();
  };
  read(title, wanted, take);
}

void Source::read(const std::string& title, const std::function<bool(const ChannelSurvey&)>& wanted,
                  const std::function<void(const Message&)>& take,
                  const std::function<void(const ForeignMessage&)>& take_foreign) {
  std::set<std::pair<std::string, const types::Struct*>> foreign;
  for (const ChannelSurvey& channel : survey_.channels)
    if (take_foreign && is_foreign_selected(channel))
      foreign.insert({channel.channel, channel.foreign});
  std::unordered_map<std::string, std::vector<std::unique_ptr<log::Record>>> records;
  for (const ChannelSurvey& channel : survey_.channels)
    if (channel.type && wanted(channel))
      records[channel.channel].push_back(std::make_unique<log::Record>(*channel.type));

  log_.rewind();
  Stage stage(options_.quiet, title, log_.size());
  std::int64_t events = 0, last_sent = survey_.sent.first;
  while (const bus::LoggedEvent* event = log_.next()) {
    if (events++ % kReportEvery == 0)
      stage.show(static_cast<double>(log_.place()) / static_cast<double>(log_.size()));
    if (options_.clock == Clock::kSent) {
      const std::optional<Head> head = head_of(*event);
      if (head && survey_.strange_clocks.count(head->session) == 0) last_sent = head->utime;
    }
    const std::int64_t utime = options_.clock == Clock::kReceived ? event->utime : last_sent;
    if (!foreign.empty() && is_in_time(time(utime))) {
      const types::Struct* described = types_.type_of(event->data, event->size);
      if (described != nullptr && foreign.count({event->channel, described}) > 0 &&
          types::fits(*described, event->data, event->size))
        take_foreign({*event, *described, time(utime), utime});
    }
    const auto found = records.find(event->channel);
    if (found == records.end()) continue;
    const log::TypeInfo* type = log::type_of(event->data, event->size);
    for (const auto& record : found->second) {
      if (&record->type() != type || !record->decode(event->data, event->size)) continue;
      take({*event, *record, time(utime), utime});
    }
  }
  stage.finish();
}

}  // namespace palpate::exporting
