#include "tools/top/view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "rt/client/client.hpp"
#include "tools/common/discrepancy_text.hpp"
#include "tools/common/table.hpp"

namespace palpate::top {
namespace {

using Count = long long;

using common::formatted;

/// "12.3", or "-" if unknown.
std::string figure(double value, bool known) {
  return known && std::isfinite(value) ? formatted("%.*f", std::abs(value) < 100 ? 2 : 0, value)
                                       : "-";
}

std::string age(double seconds) {
  return seconds < 10 ? formatted("%.0f ms", 1e3 * seconds) : formatted("%.0f s", seconds);
}

void add_counters(const health_t& health, std::vector<Line>& lines) {
  const auto word = [](const char* what, std::int64_t count) {
    return formatted("%s %lld", what, static_cast<Count>(count));
  };
  lines.push_back({word("cycles", health.cycles) + word(", overruns", health.overruns) +
                   formatted(" (%.1f ms)", static_cast<double>(health.overrun_us) * 1e-3) +
                   word(", not converged", health.shapes_not_converged) +
                   word(", page faults", health.page_faults) +
                   (health.allocations < 0 ? ", allocations not counted"
                                           : word(", allocations", health.allocations))});
  lines.push_back(
      {word("gate limited", health.gate_limited) + word(", rejected", health.gate_rejected) +
       word("; commands rejected", health.commands_rejected) +
       word("; telemetry dropped", health.telemetry_dropped) +
       word("; datagrams malformed", health.malformed) + word(", fragments", health.fragmented) +
       word(", overflowed", health.overflowed)});
  if (health.allocations > 0) lines.back().tone = Tone::kWarning;
}

void add_phases(const health_t& health, std::vector<Line>& lines) {
  const int phases = std::clamp(health.phase_count, 0, kPhases);
  if (phases == 0) return;
  std::string header = formatted("%-8s", "us");
  for (int i = 0; i < phases; ++i)
    header += formatted("%11s", kPhaseNames[static_cast<std::size_t>(i)]);
  lines.push_back({header, Tone::kTitle});
  const std::pair<const char*, const float*> quantiles[] = {{"p50", health.p50_us},
                                                            {"p99", health.p99_us},
                                                            {"p99.9", health.p999_us},
                                                            {"max", health.max_us}};
  for (const auto& [label, values] : quantiles) {
    std::string line = formatted("%-8s", label);
    for (int i = 0; i < phases; ++i) line += formatted("%11.1f", static_cast<double>(values[i]));
    lines.push_back({line});
  }
}

void add_inputs(const health_t& health, std::vector<Line>& lines) {
  const int inputs = std::clamp(health.input_count, 0, 16);
  if (inputs == 0) return;
  lines.push_back({formatted("%-24s %10s %8s %8s %8s %10s", "input", "received", "lost", "rejected",
                             "frozen", "age"),
                   Tone::kTitle});
  for (int i = 0; i < inputs; ++i) {
    if (health.received[i] == 0 && health.rejected[i] == 0) continue;
    const bool is_bad = health.lost[i] + health.rejected[i] + health.frozen[i] > 0;
    lines.push_back(
        {formatted("%-24s %10lld %8lld %8lld %8lld %10s",
                   printable(health.input_name[i], sizeof(health.input_name[i])).c_str(),
                   static_cast<Count>(health.received[i]), static_cast<Count>(health.lost[i]),
                   static_cast<Count>(health.rejected[i]), static_cast<Count>(health.frozen[i]),
                   health.age_ms[i] < 0
                       ? "never"
                       : age(1e-3 * static_cast<double>(health.age_ms[i])).c_str()),
         is_bad ? Tone::kWarning : Tone::kPlain});
  }
}

Tone tone_of(int state) {
  return state == 2   ? Tone::kGood
         : state == 3 ? Tone::kWarning
         : state == 4 ? Tone::kBad
                      : Tone::kTitle;
}

/// Nothing without a test.
void add_discrepancy(const View& view, std::vector<Line>& lines) {
  const discrepancy_t* test = view.daemon->discrepancy(view.now_ns);
  if (test == nullptr || test->test < 0) return;
  const std::string numbers = formatted("test %.2f, threshold %.2f", test->test, test->threshold);
  if (test->inconsistent == 0) {
    lines.push_back({"wrenches agree with the model: " + numbers});
    return;
  }
  std::string line = formatted("wrenches contradict the model for %.1f s: ", test->duration) +
                     numbers + ", " + common::component_text(*test);
  if (common::explanation_count(*test) > 0)
    line += "; most likely " + common::explanation_text(*test, 0) +
            formatted(" (%.2f)", test->probability[0]);
  lines.push_back({line, Tone::kBad});
}

void add_state(const View& view, const health_t& health, std::vector<Line>& lines) {
  const double silent = view.daemon->health_age(view.now_ns);
  const std::string reason = printable(health.reason, sizeof(health.reason));
  lines.push_back({std::string("palpated: ") + client::name_of_state(health) +
                       (reason.empty() ? "" : ": " + reason),
                   tone_of(health.state)});
  if (silent > 1) lines.push_back({"silent for " + age(silent), Tone::kBad});
  const int daemons = view.daemon->daemons(view.now_ns);
  if (daemons > 1) {
    lines.push_back(
        {formatted("%d daemons speak at once: each URL may have but one", daemons), Tone::kBad});
  }
  if (!view.daemon->event().empty()) lines.push_back({"last event: " + view.daemon->event()});
}

void add_daemon(const View& view, std::vector<Line>& lines) {
  if (view.daemon == nullptr || !view.daemon->health()) {
    lines.push_back({"palpated: nothing heard", Tone::kWarning});
    if (view.daemon != nullptr) add_discrepancy(view, lines);
    return;
  }
  const health_t& health = *view.daemon->health();
  add_state(view, health, lines);
  add_discrepancy(view, lines);
  add_counters(health, lines);
  add_phases(health, lines);
  add_inputs(health, lines);
}

Tone tone_of(const ChannelRow& row) {
  if (row.misfits > 0) return Tone::kBad;
  if (row.lost > 0 || (row.rate <= 0 && row.age > 2)) return Tone::kWarning;
  return Tone::kPlain;
}

void add_channels(const View& view, std::vector<Line>& lines) {
  lines.push_back({formatted("%-13s %-23s %-20s %8s %8s %8s %8s %8s %8s %9s", "url", "channel",
                             "type", "Hz", "jitter", "longest", "age", "latency", "lost", "kB/s"),
                   Tone::kTitle});
  for (const ChannelRow& row : view.rows) {
    const std::string type = row.misfits > 0 ? "! broken" : row.type.empty() ? "unknown" : row.type;
    lines.push_back(
        {formatted("%-13s %-23s %-20s %8.1f %8s %8s %8s %8s %8lld %9.1f",
                   view.sources[static_cast<std::size_t>(row.source)].label.c_str(),
                   row.channel.c_str(), type.c_str(), row.rate,
                   figure(row.jitter_ms, row.jitter_ms >= 0).c_str(),
                   figure(row.longest_ms, row.longest_ms >= 0).c_str(), age(row.age).c_str(),
                   figure(row.latency_ms, row.has_latency).c_str(), static_cast<Count>(row.lost),
                   1e-3 * row.bandwidth),
         tone_of(row)});
  }
  if (view.rows.empty()) lines.push_back({"nothing heard on any channel", Tone::kWarning});
}

/// Numbers of one array share lines.
void add_values(const types::ShownMessage& message, std::vector<Line>& lines) {
  for (std::size_t i = 0; i < message.values.size();) {
    const std::size_t end = types::line_end(message.values, i);
    const auto [name, text] = types::line_of(message.values, i, end);
    lines.push_back({formatted("  %-32s ", name.c_str()) + text});
    i = end;
  }
  if (message.left_out > 0)
    lines.push_back({formatted("  and %lld values more", static_cast<Count>(message.left_out))});
}

double age_of(const types::ShownMessage& message, std::int64_t now_ns) {
  return std::max(0.0, 1e-9 * static_cast<double>(now_ns - 1000 * message.time_us));
}

void add_messages(const View& view, std::vector<Line>& lines) {
  for (const types::ShownMessage& message : view.messages) {
    const std::string head = view.sources[static_cast<std::size_t>(message.source)].label + " " +
                             message.channel + ", " + age(age_of(message, view.now_ns)) + " old";
    if (message.type.empty())
      lines.push_back(
          {head + ": of a type that is not known; --types names descriptions", Tone::kWarning});
    else if (!message.fits)
      lines.push_back({head + ": broken, no " + message.type, Tone::kBad});
    else
      lines.push_back({head + ": " + message.type, Tone::kTitle});
    add_values(message, lines);
    lines.push_back({""});
  }
}

void add_datagrams(const View& view, std::vector<Line>& lines) {
  if (view.listener == nullptr) return;
  for (int i = 0; i < static_cast<int>(view.sources.size()); ++i) {
    const bus::DatagramCounters& counters = view.listener->datagrams(i);
    const std::int64_t rejected = counters.malformed + counters.fragmented;
    lines.push_back(
        {formatted("%s %s: %lld datagrams, malformed %lld, fragments %lld, lost here %lld",
                   view.sources[static_cast<std::size_t>(i)].label.c_str(),
                   view.sources[static_cast<std::size_t>(i)].url.group().c_str(),
                   static_cast<Count>(counters.received), static_cast<Count>(counters.malformed),
                   static_cast<Count>(counters.fragmented),
                   static_cast<Count>(counters.overflowed)),
         rejected + counters.overflowed > 0 ? Tone::kWarning : Tone::kPlain});
  }
}

const char* colour(Tone tone) {
  constexpr const char* kNames[] = {"", "\x1b[1m", "\x1b[1;32m", "\x1b[33m", "\x1b[1;31m"};
  return kNames[static_cast<std::size_t>(tone)];
}

nlohmann::json json_of(const health_t& health) {
  nlohmann::json json = {{"state", client::name_of_state(health)},
                         {"reason", printable(health.reason, sizeof(health.reason))},
                         {"cycles", health.cycles},
                         {"overruns", health.overruns},
                         {"overrun_us", health.overrun_us},
                         {"shapes_not_converged", health.shapes_not_converged},
                         {"page_faults", health.page_faults},
                         {"allocations", health.allocations},
                         {"gate_limited", health.gate_limited},
                         {"gate_rejected", health.gate_rejected},
                         {"commands_rejected", health.commands_rejected},
                         {"telemetry_dropped", health.telemetry_dropped},
                         {"malformed", health.malformed},
                         {"overflowed", health.overflowed}};
  for (int i = 0; i < std::clamp(health.phase_count, 0, kPhases); ++i) {
    json["latency_us"][kPhaseNames[static_cast<std::size_t>(i)]] = {{"p50", health.p50_us[i]},
                                                                    {"p99", health.p99_us[i]},
                                                                    {"p99.9", health.p999_us[i]},
                                                                    {"max", health.max_us[i]}};
  }
  for (int i = 0; i < std::clamp(health.input_count, 0, 16); ++i) {
    json["inputs"][printable(health.input_name[i], sizeof(health.input_name[i]))] = {
        {"received", health.received[i]},
        {"lost", health.lost[i]},
        {"rejected", health.rejected[i]},
        {"frozen", health.frozen[i]},
        {"age_ms", health.age_ms[i]}};
  }
  return json;
}

nlohmann::json json_of(const discrepancy_t& test) {
  nlohmann::json explanations = nlohmann::json::array();
  for (int i = 0; i < common::explanation_count(test); ++i)
    explanations.push_back(
        {{"text", common::explanation_text(test, i)}, {"probability", test.probability[i]}});
  return {{"inconsistent", test.inconsistent != 0},
          {"duration_s", test.duration},
          {"test", test.test},
          {"threshold", test.threshold},
          {"component", common::component_text(test)},
          {"explanations", explanations}};
}

}  // namespace

std::vector<Line> lines_of(const View& view) {
  std::vector<Line> lines;
  add_daemon(view, lines);
  lines.push_back({""});
  add_channels(view, lines);
  lines.push_back({""});
  add_messages(view, lines);
  add_datagrams(view, lines);
  return lines;
}

nlohmann::json json_of(const View& view) {
  nlohmann::json json = {
      {"version", PALPATE_VERSION}, {"daemon", nullptr}, {"channels", nlohmann::json::array()}};
  if (view.daemon != nullptr && view.daemon->health()) {
    json["daemon"] = json_of(*view.daemon->health());
    json["daemon"]["silent_s"] = view.daemon->health_age(view.now_ns);
    json["daemon"]["daemons"] = view.daemon->daemons(view.now_ns);
    json["daemon"]["last_event"] = view.daemon->event();
    if (const discrepancy_t* test = view.daemon->discrepancy(view.now_ns))
      json["daemon"]["discrepancy"] = json_of(*test);
  }
  const auto known = [](double value, bool is) {
    return is ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  for (const ChannelRow& row : view.rows) {
    json["channels"].push_back({{"url", view.sources[static_cast<std::size_t>(row.source)].label},
                                {"channel", row.channel},
                                {"type", row.type},
                                {"known", !row.type.empty()},
                                {"messages", row.messages},
                                {"rate", row.rate},
                                {"jitter_ms", known(row.jitter_ms, row.jitter_ms >= 0)},
                                {"longest_ms", known(row.longest_ms, row.longest_ms >= 0)},
                                {"age_s", row.age},
                                {"latency_ms", known(row.latency_ms, row.has_latency)},
                                {"lost", row.lost},
                                {"misfits", row.misfits},
                                {"senders", row.senders},
                                {"bandwidth", row.bandwidth}});
  }
  for (const types::ShownMessage& message : view.messages) {
    nlohmann::json values = nlohmann::json::object();
    for (const types::ShownMessage::Value& value : message.values) {
      // A text that JSON takes as a number has the same value; nan and inf stay texts.
      const bool is_json = value.is_number && nlohmann::json::accept(value.text);
      values[value.path] = is_json ? nlohmann::json::parse(value.text) : nlohmann::json(value.text);
    }
    json["values"].push_back({{"url", view.sources[static_cast<std::size_t>(message.source)].label},
                              {"channel", message.channel},
                              {"type", message.type},
                              {"fits", message.fits},
                              {"age_s", age_of(message, view.now_ns)},
                              {"messages", message.messages},
                              {"malformed", message.malformed},
                              {"left_out", message.left_out},
                              {"fields", values}});
  }
  for (int i = 0; view.listener != nullptr && i < static_cast<int>(view.sources.size()); ++i) {
    const bus::DatagramCounters& counters = view.listener->datagrams(i);
    json["urls"][view.sources[static_cast<std::size_t>(i)].label] = {
        {"url", view.sources[static_cast<std::size_t>(i)].url.text()},
        {"datagrams", counters.received.load()},
        {"malformed", counters.malformed.load()},
        {"fragmented", counters.fragmented.load()},
        {"overflowed", counters.overflowed.load()}};
  }
  return json;
}

std::string frame(const std::vector<Line>& lines, int columns, int rows, int first, bool colours,
                  const std::string& keys) {
  std::string text = "\x1b[H";
  const auto put = [&](const Line& line) {
    const bool marked = !colours && line.tone == Tone::kBad;
    const std::string shown = (marked ? "! " : "") + line.text;
    const char* on = colours ? colour(line.tone) : "";
    text += on + shown.substr(0, static_cast<std::size_t>(std::max(0, columns)));
    text += std::string(*on != '\0' ? "\x1b[0m" : "") + "\x1b[K";
  };
  const int room = std::max(0, rows - 1);
  for (int i = first; i < first + room && i < static_cast<int>(lines.size()); ++i) {
    put(lines[static_cast<std::size_t>(i)]);
    text += "\r\n";
  }
  text += "\x1b[J";
  // In the last row, without an end of line, which would scroll the screen.
  text += "\x1b[" + std::to_string(std::max(1, rows)) + ";1H";
  put({keys, Tone::kTitle});
  return text;
}

}  // namespace palpate::top
