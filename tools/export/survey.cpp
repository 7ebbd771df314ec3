#include "tools/export/survey.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>

#include "tools/common/table.hpp"
#include "tools/export/columns.hpp"

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
  if (channel.foreign != nullptr) {
    if (!channel.foreign_columns.add(*channel.foreign, event.data, event.size)) ++channel.broken;
    return;
  }
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

std::string hex(std::uint64_t number) {
  return common::formatted("%016llx", static_cast<unsigned long long>(number));
}

std::string clock_text(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm parts{};
  if (gmtime_r(&seconds, &parts) == nullptr) return std::to_string(utime) + " us";
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
  return text + common::formatted(".%03d UTC", static_cast<int>(utime / 1000 % 1000));
}

void print_row(std::ostream& out, const ChannelSurvey& channel) {
  char text[256];
  const std::string type =
      channel.is_known() ? channel.type_name() : "? " + hex(channel.fingerprint);
  std::snprintf(text, sizeof text, "%-26s %-26s %9lld %9.1f %9.1f %8lld %7lld %9zu",
                channel.channel.c_str(), type.c_str(), static_cast<long long>(channel.messages),
                channel.rate(), 1e-3 * static_cast<double>(channel.longest_gap),
                static_cast<long long>(channel.lost()), static_cast<long long>(channel.broken),
                channel.sessions.size());
  out << text << '\n';
}

void print_sessions(std::ostream& out, const ChannelSurvey& channel) {
  for (const auto& [session, entry] : channel.sessions) {
    const log::Sequence& sequence = entry.sequence;
    const bool is_odd = sequence.lost() + sequence.late() + sequence.repeated() > 0;
    if (channel.sessions.size() < 2 && !is_odd) continue;
    out << "    " << channel.channel << ", session " << hex(static_cast<std::uint64_t>(session))
        << ": " << sequence.received() << " messages, " << sequence.lost() << " lost, "
        << sequence.late() << " overtaken, " << sequence.repeated() << " repeated\n";
  }
}

/// Array sizes as [n][m]; sizes that vary between messages are given as the largest.
std::string shape_text(const log::FieldInfo& field, int width) {
  if (field.is_scalar()) return "";
  const int rows = field.row_size() > 0 ? width / field.row_size() : 0;
  std::string text = "[" + std::to_string(rows) + "]";
  for (std::size_t d = 1; d < field.sizes.size(); ++d)
    text += "[" + std::to_string(field.sizes[d]) + "]";
  return text;
}

std::string units_of(const log::FieldInfo& field) {
  std::string text;
  std::string last;
  for (std::size_t i = 0; i < field.units.size(); ++i) {
    const std::string unit = unit_text(field, static_cast<int>(i));
    if (unit != last) text += (text.empty() ? "" : ", ") + unit;
    last = unit;
  }
  return text;
}

/// One line for each array or number; arrays as long as their longest one.
void print_foreign_fields(const ChannelSurvey& channel, std::ostream& out) {
  out << channel.channel << "  (" << channel.foreign->name << ": " << channel.foreign->comment
      << ")\n";
  if (channel.foreign_columns.is_too_wide())
    out << "  more than " << ForeignColumns::kMost << " values\n";
  const auto& columns = channel.foreign_columns.columns();
  for (auto column = columns.begin(); column != columns.end();) {
    const types::Member* member = column->second.member;
    const std::string first = column->second.path;
    const std::string array = first.substr(0, first.rfind('['));
    std::int64_t count = 0;
    do {
      ++count;
      ++column;
    } while (first.back() == ']' && column != columns.end() && column->second.member == member &&
             column->second.path.substr(0, column->second.path.rfind('[')) == array);
    const std::string name = count > 1 ? array + "[" + std::to_string(count) + "]" : first;
    out << common::formatted("  %-34s %-14s %s", name.c_str(), member->type.c_str(),
                             member->comment.c_str())
        << '\n';
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

std::string ChannelSurvey::type_name() const {
  return type != nullptr ? type->name : foreign != nullptr ? foreign->name : "";
}

const ChannelSurvey* Survey::find(const std::string& channel, const log::TypeInfo* type) const {
  for (const ChannelSurvey& entry : channels)
    if (entry.channel == channel && entry.type == type) return &entry;
  return nullptr;
}

std::int64_t Survey::unknown() const {
  std::int64_t sum = 0;
  for (const ChannelSurvey& channel : channels) sum += channel.is_known() ? 0 : channel.messages;
  return sum;
}

std::int64_t Survey::broken() const {
  std::int64_t sum = 0;
  for (const ChannelSurvey& channel : channels) sum += channel.broken;
  return sum;
}

Survey survey(log::MergedLog& log, const std::function<void(double)>& progress,
              const types::TypeSet& foreign) {
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
      } else {
        entry.survey.foreign = foreign.type_of(event->data, event->size);
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

void print_info(const Survey& survey, std::ostream& out) {
  out << common::formatted("%lld events in %.1f MB", static_cast<long long>(survey.events),
                           1e-6 * static_cast<double>(survey.bytes));
  if (!survey.received.empty)
    out << common::formatted(", %.3f s, from ", survey.received.seconds())
        << clock_text(survey.received.first) << " to " << clock_text(survey.received.last);
  out << "\n\n";
  out << common::formatted("%-26s %-26s %9s %9s %9s %8s %7s %9s", "channel", "type", "messages",
                           "rate, Hz", "gap, ms", "lost", "broken", "sessions")
      << '\n';
  for (const ChannelSurvey& channel : survey.channels)
    if (channel.is_known()) print_row(out, channel);
  for (const ChannelSurvey& channel : survey.channels)
    if (!channel.is_known()) print_row(out, channel);
  out << '\n';
  for (const ChannelSurvey& channel : survey.channels) print_sessions(out, channel);
  out << survey.unknown() << " messages of unknown types, " << survey.broken() << " broken ones\n";
  for (const std::string& complaint : survey.complaints) out << "damaged: " << complaint << '\n';
}

nlohmann::json info_json(const Survey& survey) {
  nlohmann::json channels = nlohmann::json::array();
  for (const ChannelSurvey& channel : survey.channels) {
    nlohmann::json sessions = nlohmann::json::array();
    for (const auto& [session, entry] : channel.sessions) {
      const log::Sequence& sequence = entry.sequence;
      sessions.push_back({{"session", hex(static_cast<std::uint64_t>(session))},
                          {"messages", sequence.received()},
                          {"lost", sequence.lost()},
                          {"overtaken", sequence.late()},
                          {"repeated", sequence.repeated()},
                          {"strange_clock", survey.strange_clocks.count(session) > 0}});
    }
    channels.push_back(
        {{"channel", channel.channel},
         {"type", channel.is_known() ? nlohmann::json(channel.type_name()) : nullptr},
         {"fingerprint", hex(channel.fingerprint)},
         {"messages", channel.messages},
         {"bytes", channel.bytes},
         {"rate", channel.rate()},
         {"longest_gap", channel.longest_gap},
         {"lost", channel.lost()},
         {"broken", channel.broken},
         {"received_first", channel.received.first},
         {"received_last", channel.received.last},
         {"sent_first", channel.sent.first},
         {"sent_last", channel.sent.last},
         {"sessions", sessions}});
  }
  return {{"events", survey.events},
          {"bytes", survey.bytes},
          {"received_first", survey.received.first},
          {"received_last", survey.received.last},
          {"unknown", survey.unknown()},
          {"broken", survey.broken()},
          {"damage", survey.complaints},
          {"channels", channels}};
}

void print_fields(const Survey& survey, std::ostream& out) {
  for (const ChannelSurvey& channel : survey.channels) {
    if (channel.foreign != nullptr) {
      print_foreign_fields(channel, out);
      continue;
    }
    if (!channel.type) continue;
    out << channel.channel << "  (" << channel.type->name << ": " << channel.type->comment << ")\n";
    for (std::size_t f = 0; f < channel.type->fields.size(); ++f) {
      const log::FieldInfo& field = channel.type->fields[f];
      if (field.is_bytes()) continue;
      out << common::formatted("  %-34s %-14s %s",
                               (field.name + shape_text(field, channel.widths[f])).c_str(),
                               units_of(field).c_str(), field.comment.c_str())
          << '\n';
    }
  }
}

}  // namespace palpate::exporting
