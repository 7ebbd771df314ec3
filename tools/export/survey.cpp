#include "tools/export/survey.hpp"

#include <algorithm>
#include <optional>

namespace palpate::exporting {
namespace {

constexpr std::int64_t kSurveyReportEvery = 20'000;  // events

std::uint64_t fingerprint_of(const bus::LoggedEvent& event) {
  std::uint64_t fingerprint = 0;
  if (event.size < 8) return 0;
  for (int i = 0; i < 8; ++i) fingerprint = fingerprint << 8 | event.data[i];
  return fingerprint;
}

struct Entry {
  ChannelSurvey survey;
  std::optional<log::Record> record;
};

void count(Entry& entry, const bus::LoggedEvent& event) {
  ChannelSurvey& channel = entry.survey;
  if (channel.messages++ > 0)
    channel.longest_gap = std::max(channel.longest_gap, event.utime - channel.received.last);
  channel.bytes += event.size;
  channel.received.add(event.utime);
  if (!entry.record) return;
  if (!entry.record->decode(event.data, event.size)) {
    ++channel.broken;
    return;
  }
  channel.sent.add(entry.record->utime());
  SessionSurvey& session = channel.sessions[entry.record->session()];
  session.sequence.add(entry.record->seq());
  session.sent.add(entry.record->utime());
  for (std::size_t f = 0; f < channel.widths.size(); ++f)
    channel.widths[f] = std::max(channel.widths[f], entry.record->used(static_cast<int>(f)));
}

/// Of all channels together, by session.
void compare_clocks(Survey& survey) {
  struct Sender {
    TimeSpan sent;
    std::int64_t messages = 0;
  };
  std::map<std::int64_t, Sender> senders;
  for (const ChannelSurvey& channel : survey.channels)
    for (const auto& [session, entry] : channel.sessions) {
      senders[session].sent.add(entry.sent.first);
      senders[session].sent.add(entry.sent.last);
      senders[session].messages += entry.sequence.received();
    }
  if (senders.empty()) return;
  const TimeSpan reference =
      std::max_element(senders.begin(), senders.end(), [](const auto& a, const auto& b) {
        return a.second.messages < b.second.messages;
      })->second.sent;
  for (const auto& [session, sender] : senders) {
    // Halved to avoid overflow, since a clock may have any 64-bit value.
    const bool is_near = sender.sent.last / 2 >= reference.first / 2 - kStrangeClock / 2 &&
                         sender.sent.first / 2 <= reference.last / 2 + kStrangeClock / 2;
    if (!is_near) {
      survey.strange_clocks.insert(session);
      continue;
    }
    survey.sent.add(sender.sent.first);
    survey.sent.add(sender.sent.last);
  }
}

}  // namespace

void TimeSpan::add(std::int64_t utime) {
  first = empty ? utime : std::min(first, utime);
  last = empty ? utime : std::max(last, utime);
  empty = false;
}

double ChannelSurvey::rate() const {
  const double duration = received.seconds();
  return messages < 2 || duration <= 0 ? 0 : static_cast<double>(messages - 1) / duration;
}

std::int64_t ChannelSurvey::lost() const {
  std::int64_t sum = 0;
  for (const auto& [session, entry] : sessions) sum += entry.sequence.lost();
  return sum;
}

const ChannelSurvey* Survey::find(const std::string& channel, const log::TypeInfo* type) const {
  for (const ChannelSurvey& entry : channels)
    if (entry.channel == channel && entry.type == type) return &entry;
  return nullptr;
}

std::int64_t Survey::unknown() const {
  std::int64_t sum = 0;
  for (const ChannelSurvey& channel : channels) sum += channel.type ? 0 : channel.messages;
  return sum;
}

std::int64_t Survey::broken() const {
  std::int64_t sum = 0;
  for (const ChannelSurvey& channel : channels) sum += channel.broken;
  return sum;
}

Survey survey(log::MergedLog& log, const std::function<void(double)>& progress) {
  std::map<std::pair<std::string, std::uint64_t>, Entry> entries;
  Survey result;
  result.bytes = log.size();
  while (const bus::LoggedEvent* event = log.next()) {
    if (progress && result.events % kSurveyReportEvery == 0)
      progress(static_cast<double>(log.place()) / static_cast<double>(log.size()));
    ++result.events;
    result.received.add(event->utime);
    const std::uint64_t fingerprint = fingerprint_of(*event);
    const auto [found, is_new] = entries.try_emplace({event->channel, fingerprint});
    Entry& entry = found->second;
    if (is_new) {
      entry.survey.channel = event->channel;
      entry.survey.fingerprint = fingerprint;
      entry.survey.type = log::type_of(event->data, event->size);
      if (entry.survey.type) {
        entry.record.emplace(*entry.survey.type);
        entry.survey.widths.resize(entry.survey.type->fields.size());
      }
    }
    count(entry, *event);
  }
  result.complaints = log.complaints();
  for (auto& [key, entry] : entries) {
    result.channels.push_back(std::move(entry.survey));
  }
  compare_clocks(result);
  return result;
}

}  // namespace palpate::exporting
