#include "tools/record/summary.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::record {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// Message rate, between the first and the last.
double rate(const ChannelSummary& channel) {
  const auto span = static_cast<double>(channel.last_utime - channel.first_utime) * 1e-6;
  return span > 0 ? static_cast<double>(channel.messages - 1) / span : 0;
}

const char* type_name(const ChannelSummary& channel) {
  return channel.type.empty() ? "unknown" : channel.type.c_str();
}

using Count = long long;

}  // namespace

void print_summary(const Recorder& recorder, const Listener& listener, double seconds,
                   std::ostream& out) {
  const Recorder::Totals totals = recorder.totals();
  out << formatted("%-14s %-24s %-24s %10s %9s %10s %7s %7s\n", "url", "channel", "type",
                   "messages", "Hz", "kB", "lost", "misfits");
  for (const ChannelSummary& one : recorder.channels()) {
    out << formatted("%-14s %-24s %-24s %10lld %9.1f %10.1f %7lld %7lld\n",
                     listener.sources()[static_cast<std::size_t>(one.source)].label.c_str(),
                     one.channel.c_str(), type_name(one), static_cast<Count>(one.messages),
                     rate(one), static_cast<double>(one.bytes) * 1e-3, static_cast<Count>(one.lost),
                     static_cast<Count>(one.misfits));
  }
  out << formatted(
      "%lld messages, %.1f MB in %.1f s; lost on the way %lld, dropped since the disk "
      "was slow %lld\n",
      static_cast<Count>(totals.messages), static_cast<double>(totals.bytes) * 1e-6, seconds,
      static_cast<Count>(totals.lost), static_cast<Count>(totals.unwritten));
  for (int i = 0; i < static_cast<int>(listener.sources().size()); ++i) {
    const bus::DatagramCounters& counters = listener.datagrams(i);
    out << formatted(
        "%s: %lld datagrams, refused %lld malformed and %lld fragments, lost in the "
        "socket's buffer %lld\n",
        listener.sources()[static_cast<std::size_t>(i)].label.c_str(),
        static_cast<Count>(counters.received), static_cast<Count>(counters.malformed),
        static_cast<Count>(counters.fragmented), static_cast<Count>(counters.overflowed));
  }
  for (const std::string& file : recorder.files()) out << file << '\n';
}

nlohmann::json summary_json(const Recorder& recorder, const Listener& listener, double seconds) {
  const Recorder::Totals totals = recorder.totals();
  nlohmann::json json = {{"version", PALPATE_VERSION},
                         {"duration_s", seconds},
                         {"messages", totals.messages},
                         {"bytes", totals.bytes},
                         {"lost", totals.lost},
                         {"misfits", totals.misfits},
                         {"unwritten", totals.unwritten},
                         {"files", recorder.files()},
                         {"channels", nlohmann::json::array()}};
  for (const ChannelSummary& one : recorder.channels()) {
    json["channels"].push_back(
        {{"url", listener.sources()[static_cast<std::size_t>(one.source)].label},
         {"channel", one.channel},
         {"type", one.type},
         {"messages", one.messages},
         {"rate", rate(one)},
         {"bytes", one.bytes},
         {"lost", one.lost},
         {"misfits", one.misfits},
         {"senders", one.senders}});
  }
  for (int i = 0; i < static_cast<int>(listener.sources().size()); ++i) {
    const Source& source = listener.sources()[static_cast<std::size_t>(i)];
    const bus::DatagramCounters& counters = listener.datagrams(i);
    json["urls"][source.label] = {{"url", source.url.text()},
                                  {"datagrams", counters.received.load()},
                                  {"malformed", counters.malformed.load()},
                                  {"fragmented", counters.fragmented.load()},
                                  {"overflowed", counters.overflowed.load()},
                                  {"receive_buffer", listener.receive_buffer_size(i)}};
  }
  return json;
}

}  // namespace palpate::record
