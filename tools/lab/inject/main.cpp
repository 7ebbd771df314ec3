// palpate-inject: sends malformed packets, or a flood of packets, to an LCM URL. See --help.

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/config/command_line.hpp"
#include "tools/lab/inject/packets.hpp"
#include "tools/lab/inject/sender.hpp"

namespace {

using namespace palpate::inject;

volatile std::sig_atomic_t stopped = 0;

struct Options {
  std::string url;
  std::string json;
  double rate = 0;
  // malformed
  std::int64_t count = 100000;
  std::uint64_t seed = 1;
  std::vector<std::string> kinds;
  std::vector<std::string> channels;
  // flood
  double seconds = 10;
  std::string channel = "FLOOD";
  int size = 100;
  bool as_type = false;
};

/// One line on stderr, a few times per second.
void show(const Sender& sender, double part) {
  static double next = 0;
  if (sender.elapsed() < next) return;
  next = sender.elapsed() + 0.5;
  std::fprintf(stderr, "\r%5.1f %%  %lld datagrams, %.0f/s ", 100 * part,
               static_cast<long long>(sender.sent()),
               static_cast<double>(sender.sent()) / std::max(1e-3, sender.elapsed()));
}

nlohmann::json summary(const Sender& sender) {
  const double elapsed = sender.elapsed();
  return {{"sent", sender.sent()},
          {"refused", sender.refused()},
          {"seconds", elapsed},
          {"rate", elapsed > 0 ? static_cast<double>(sender.sent()) / elapsed : 0}};
}

std::vector<Target> chosen_targets(const std::vector<std::string>& channels) {
  const std::vector<Target> all = usual_targets();
  if (channels.empty()) return all;
  std::vector<Target> chosen;
  for (const std::string& channel : channels) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Target& one) { return one.channel == channel; });
    if (found == all.end()) throw std::invalid_argument("no type is known for " + channel);
    chosen.push_back(*found);
  }
  return chosen;
}

nlohmann::json send_malformed(const Options& options) {
  std::vector<Kind> kinds;
  for (const std::string& text : options.kinds) {
    if (text == "all") {
      kinds = malformed_kinds();
      kinds.push_back(Kind::kRandomPayload);
    } else {
      kinds.push_back(kind_from(text));
    }
  }
  if (kinds.empty()) kinds = malformed_kinds();
  PacketSource source(options.seed, kinds, chosen_targets(options.channels));
  Sender sender(palpate::bus::parse_udpm_url(options.url), options.rate);
  std::map<std::string, std::int64_t> by_kind;
  for (std::int64_t i = 0; i < options.count && stopped == 0; ++i) {
    sender.send(source.next());
    ++by_kind[name(source.kind())];
    show(sender, static_cast<double>(i) / static_cast<double>(options.count));
  }
  sender.flush();
  nlohmann::json json = summary(sender);
  json["seed"] = options.seed;
  json["kinds"] = by_kind;
  return json;
}

nlohmann::json send_flood(const Options& options) {
  std::vector<std::uint8_t> payload(static_cast<std::size_t>(options.size));
  std::vector<std::uint8_t> datagram;
  if (options.as_type) {
    PacketSource source(options.seed, {Kind::kRandomPayload}, chosen_targets({options.channel}));
    datagram = source.next();
  } else {
    datagram = short_message(0, options.channel, payload);
  }
  Sender sender(palpate::bus::parse_udpm_url(options.url), options.rate);
  while (stopped == 0 && sender.elapsed() < options.seconds) {
    sender.send(datagram);
    show(sender, sender.elapsed() / options.seconds);
  }
  sender.flush();
  return summary(sender);
}

int run(CLI::App& app, int argc, char** argv) {
  Options options;
  app.require_subcommand(1);
  app.footer(
      "Example:\n"
      "  palpate-inject malformed --url 'udpm://239.255.76.67:7667?ttl=0' --count 10000 --rate "
      "1000");
  const auto common = [&options](CLI::App* command) {
    palpate::config::add_url_option(
        *command,
        {{"control", &options.url}, {"housekeeping", &options.url}, {"pictures", &options.url}});
    palpate::config::add_deprecated_positional(*command, "url", options.url, "--url");
    command->add_option("--rate", options.rate, "datagrams a second; 0: as fast as they go")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_option("--seed", options.seed, "same seed, same datagrams")->capture_default_str();
    command->add_option("--json", options.json, "write the summary to this file");
  };
  CLI::App* malformed = app.add_subcommand(
      "malformed", "datagrams that no receiver may accept, drawn from every kind alike");
  common(malformed);
  malformed->add_option("--count", options.count, "datagrams")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
      ->capture_default_str();
  std::string kinds;
  for (int i = 0; i < kKinds; ++i)
    kinds += std::string(i == 0 ? "" : ", ") + name(static_cast<Kind>(i));
  malformed->add_option("--kind", options.kinds,
                        "only these (repeatable); all: every one; default: all but "
                        "random_payload, which is well formed. Known: " +
                            kinds);
  malformed->add_option("--channel", options.channels,
                        "only these (repeatable); default: all that palpated listens to");
  CLI::App* flood = app.add_subcommand("flood", "one message over and over");
  common(flood);
  flood->add_option("--seconds", options.seconds)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  flood->add_option("--channel", options.channel)->capture_default_str();
  CLI::Option* size = flood->add_option("--size", options.size, "bytes of payload")
                          ->check(CLI::Range(0, 60000))
                          ->capture_default_str();
  flood
      ->add_flag("--typed", options.as_type,
                 "a message of the type that belongs on the channel, of drawn numbers")
      ->excludes(size);
  if (const auto code = palpate::config::parse(
          app, argc, argv, {{{0, "all sent"}, {palpate::config::kExitInterrupted, "interrupted"}}}))
    return *code;
  if (options.url.empty()) return palpate::config::usage_error(app, "--url is required");

  std::signal(SIGINT, [](int) { stopped = 1; });
  std::signal(SIGTERM, [](int) { stopped = 1; });
  const nlohmann::json json = malformed->parsed() ? send_malformed(options) : send_flood(options);
  std::fprintf(stderr, "\r");
  std::printf("%lld datagrams sent in %.2f s, %.0f/s; %lld refused by the system\n",
              json["sent"].get<long long>(), json["seconds"].get<double>(),
              json["rate"].get<double>(), json["refused"].get<long long>());
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << json.dump(2) << '\n';
    if (!file) throw std::runtime_error(options.json + ": cannot be written");
  }
  return stopped == 0 ? 0 : palpate::config::kExitInterrupted;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-inject sends harmful input to an LCM URL: packets that are malformed in every\n"
      "way known to hurt a receiver, seeded, or far too many messages. For tests of palpated, and\n"
      "of any other receiver there; other programs may well end.");
  try {
    return run(app, argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
