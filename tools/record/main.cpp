#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <ostream>

#include "rt/config/command_line.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/common/table.hpp"
#include "tools/record/recorder.hpp"

// palpate-record: writes LCM messages of several URLs to logs. See --help.

namespace palpate::record {
namespace {

using common::formatted;

/// Message rate, between the first and the last.
double rate(const ChannelSummary& channel) {
  const auto span = static_cast<double>(channel.last_utime - channel.first_utime) * 1e-6;
  return span > 0 ? static_cast<double>(channel.messages - 1) / span : 0;
}

const char* type_name(const ChannelSummary& channel) {
  return channel.type.empty() ? "unknown" : channel.type.c_str();
}

using Count = long long;

/// Recorded, rejected and lost messages: a table of the channels, and one line each for URLs and
/// files. `seconds`: duration.
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
        "%s: %lld datagrams, rejected %lld malformed and %lld fragments, lost in the "
        "socket's buffer %lld\n",
        listener.sources()[static_cast<std::size_t>(i)].label.c_str(),
        static_cast<Count>(counters.received), static_cast<Count>(counters.malformed),
        static_cast<Count>(counters.fragmented), static_cast<Count>(counters.overflowed));
  }
  for (const std::string& file : recorder.files()) out << file << '\n';
}

/// The same as data for programs.
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

}  // namespace
}  // namespace palpate::record

namespace {

namespace record = palpate::record;
using palpate::loop::monotonic_ns;

constexpr int kNoSpace = 3;  // exit code

struct Options {
  record::RecorderOptions recorder;
  std::vector<std::string> urls, only;
  std::vector<std::filesystem::path> types;
  std::string json;
  double flush_interval_ms = 100, seconds = 0, largest_mb = 1e-6 * record::kLargestMessage;
  bool quiet = false, strftime = false;
};

constexpr char kHelp[] =
    "palpate-record writes what comes on palpate's LCM URLs to LCM event logs, which "
    "lcm-logplayer,\n"
    "palpate-replay and the rest read. It receives through palpate's own guarded receiver: the\n"
    "malformed packets that end lcm-logger are rejected and counted here.\n"
    "A URL has a log of its own: NAME.control.lcmlog, NAME.housekeeping.lcmlog, ... SIGINT and\n"
    "SIGTERM end it cleanly with a summary; SIGHUP begins the next file as --split-mb does.";
constexpr char kExamples[] =
    "Examples:\n"
    "  palpate-record                              palpate-DATE-TIME.control.lcmlog, ...\n"
    "  palpate-record --only control --split-mb 100 --rotate 5 run.lcmlog\n"
    "  palpate-record -c 'SHAPE|HEALTH|ESTIMATE' --seconds 60 --json run.json run\n"
    "  palpate-record --url control=udpm://239.255.76.67:7700?ttl=0 --merge all.lcmlog\n"
    "Messages of several fragments, which other programs send, are joined up to --largest-mb.";

void add_options(CLI::App& app, Options& options) {
  record::RecorderOptions& recorder = options.recorder;
  record::LogFileOptions& files = recorder.files;
  app.add_option("name", recorder.name,
                 "log to write; default: palpate-DATE-TIME. With several URLs the label of each is "
                 "put in front of the extension (.lcmlog where there is none)");
  record::add_url_option(app, options.urls);
  app.add_option("--only", options.only, "only the URLs of these labels")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_flag("--merge", recorder.merge, "all URLs in one log");
  app.add_option("-c,--channel", recorder.channels,
                 "regular expression that a channel's whole name matches")
      ->capture_default_str();
  app.add_flag("-v,--invert-channels", recorder.invert_channels,
               "the channels that do not match instead");
  palpate::types::add_types_option(app, options.types);
  app.add_flag(
      "--known-only", recorder.known_only,
      "leave out what is none of palpate's types and none of --types, or cannot be decoded as one");
  auto* increment = app.add_flag("-i,--increment", files.increment,
                                 "append .00, .01, ...: the first that does not exist");
  auto* rotate = app.add_option("--rotate", files.rotate,
                                "keep N files: NAME.0 is written, NAME.1 to NAME.(N-1) are older")
                     ->check(CLI::Range(1, 10000))
                     ->excludes(increment);
  app.add_option("--split-mb", files.split_mb,
                 "begin the next file beyond so many MB; needs -i or --rotate")
      ->check(CLI::PositiveNumber);
  app.add_flag("-f,--force", files.force, "overwrite")->excludes(increment)->excludes(rotate);
  app.add_flag("-s,--strftime", options.strftime,
               "fill in the name's %Y, %m, ... as strftime does");
  app.add_option("--seconds", options.seconds, "end after so many")->check(CLI::PositiveNumber);
  app.add_option("--flush-interval", options.flush_interval_ms, "ms, between two flushes")
      ->check(CLI::Range(1.0, 3.6e6))
      ->capture_default_str();
  app.add_option("-m,--max-unwritten-mb", recorder.max_unwritten_mb,
                 "messages that wait for the disk; beyond it they are dropped and counted")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--largest-mb", options.largest_mb,
                 "messages of several fragments, such as clouds of other programs, up to this "
                 "size; larger ones are rejected and counted; 0: none")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--min-free-mb", recorder.min_free_mb, "end when the disk has less left; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--json", options.json, "write the summary to this file as well");
  app.add_flag("-q,--quiet", options.quiet, "no progress and no summary");
  app.footer(kExamples);
}

std::vector<record::Source> chosen_sources(const Options& options) {
  std::vector<record::Source> sources = record::default_sources();
  record::put_urls(options.urls, sources);
  if (options.only.empty()) return sources;
  std::vector<record::Source> chosen;
  for (const std::string& label : options.only) {
    const auto found = std::find_if(sources.begin(), sources.end(),
                                    [&](const record::Source& one) { return one.label == label; });
    if (found == sources.end())
      throw std::invalid_argument("--only " + label + ": no URL has this label");
    chosen.push_back(*found);
  }
  return chosen;
}

void show_progress(const record::Recorder& recorder, double seconds) {
  const record::Recorder::Totals totals = recorder.totals();
  std::fprintf(stderr, "\r%.0f s: %lld messages, %.1f MB, %lld lost, %lld not written ", seconds,
               static_cast<long long>(totals.messages), static_cast<double>(totals.bytes) * 1e-6,
               static_cast<long long>(totals.lost), static_cast<long long>(totals.unwritten));
}

/// Writes until a signal, the time, or lack of space ends it. Returns the exit code.
int write_until_end(record::Recorder& recorder, const Options& options, const sigset_t& signals,
                    std::int64_t begin_ns) {
  const bool shows = !options.quiet && isatty(STDERR_FILENO) != 0;
  const timespec interval{0, 20'000'000};
  std::int64_t shown_ns = begin_ns;
  while (true) {
    const int signal = sigtimedwait(&signals, nullptr, &interval);
    const std::int64_t now_ns = monotonic_ns();
    const double seconds = static_cast<double>(now_ns - begin_ns) * 1e-9;
    if (!recorder.write(now_ns)) {
      std::fprintf(stderr, "%sless than %g MB are free: ends\n", shows ? "\n" : "",
                   recorder.options().min_free_mb);
      return kNoSpace;
    }
    if (signal == SIGHUP) {
      recorder.split();
    } else if (signal > 0 || (options.seconds > 0 && seconds >= options.seconds)) {
      if (shows) std::fprintf(stderr, "\n");
      return 0;
    }
    if (shows && now_ns - shown_ns > 500'000'000) {
      shown_ns = now_ns;
      show_progress(recorder, seconds);
    }
  }
}

int run(Options& options, const sigset_t& signals) {
  record::RecorderOptions& settings = options.recorder;
  const std::vector<record::Source> sources = chosen_sources(options);
  for (const record::Source& source : sources) settings.labels.push_back(source.label);
  settings.types = palpate::types::TypeSet(options.types);
  settings.flush_interval = 1e-3 * options.flush_interval_ms;
  if (settings.name.empty()) {
    settings.name = record::by_time("palpate-%Y%m%d-%H%M%S.lcmlog", std::time(nullptr));
  } else if (options.strftime) {
    settings.name = record::by_time(settings.name, std::time(nullptr));
  }
  std::unique_ptr<record::Recorder> recorder;
  // Groups are joined first: on failure no empty file is left behind.
  record::Listener listener(
      sources, [&](const record::Heard& heard) { recorder->take(heard); },
      static_cast<int>(1e6 * options.largest_mb));
  recorder = std::make_unique<record::Recorder>(settings);
  listener.start();
  const std::int64_t begin_ns = monotonic_ns();
  if (!options.quiet) {
    for (const record::Source& source : sources)
      std::printf("%s %s\n", source.label.c_str(), source.url.text().c_str());
    std::fflush(stdout);
  }
  int code = 1;
  try {
    code = write_until_end(*recorder, options, signals, begin_ns);
    listener.stop();
    recorder->finish();
  } catch (const std::runtime_error&) {
    listener.stop();
    throw;
  }
  const double seconds = static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
  if (!options.quiet) record::print_summary(*recorder, listener, seconds, std::cout);
  if (!options.json.empty())
    palpate::common::write_json(record::summary_json(*recorder, listener, seconds), options.json);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kHelp);
  Options options;
  add_options(app, options);
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{0, "ended by a signal or after --seconds"}, {kNoSpace, "the disk is nearly full"}}}))
    return *code;
  // Blocked for all threads; the writer handles them when it is ready.
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return palpate::common::run_program("error", [&] { return run(options, signals); });
}
