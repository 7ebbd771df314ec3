#include <iostream>
#include <map>

#include "tools/export/commands.hpp"

namespace palpate::exporting {
namespace {

void add(CLI::App& command, const std::string& name, const std::string& description,
         std::optional<Stiffness>& into) {
  command
      .add_option_function<std::vector<double>>(
          name,
          [&into, name](const std::vector<double>& values) {
            if (!(values[0] > 0)) throw CLI::ValidationError(name, "E must be above 0 Pa");
            if (!(values[1] > -1 && values[1] < 0.5))
              throw CLI::ValidationError(name, "Poisson's ratio must lie in (-1, 0.5)");
            into = Stiffness{values[0], values[1]};
          },
          description)
      ->expected(2)
      ->allow_extra_args(false)
      ->type_name("E NU");
}

}  // namespace

void add_source(CLI::App& command, SourceOptions& options) {
  command
      .add_option("logs", options.logs,
                  "LCM logs; several, as those of the control and the housekeeping URL of one run, "
                  "are merged by time")
      ->required()
      ->check(CLI::ExistingFile);
  types::add_types_option(command, options.types);
  command
      .add_option(
          "--clock", options.clock,
          "What times go by: 'received', when the log received a message (one clock for "
          "all), or 'sent', the utime of its sender (for runs in lock-step; senders with quite "
          "another clock, as a user, count as sent when those before them in the log were)")
      ->transform(
          CLI::CheckedTransformer(
              std::map<std::string, Clock>{{"received", Clock::kReceived}, {"sent", Clock::kSent}})
              .description(""))
      ->type_name("received|sent")
      ->default_str("received");
  command.add_option("--from", options.from, "s since the beginning; what is earlier is left out");
  command.add_option("--to", options.to, "s since the beginning; what is later is left out");
  command.add_flag("--quiet", options.quiet, "No progress");
}

void add_channels(CLI::App& command, SourceOptions& options) {
  command
      .add_option("--channel", options.channels,
                  "Only these channels; patterns as 'BIOTAC_*' (default: all)")
      ->type_name("NAME ...");
}

void report(const std::vector<Written>& written, const Source& source) {
  for (const Written& file : written)
    std::cout << file.file.string() << ": " << file.what << ", " << file.count << '\n';
  const Survey& found = source.found();
  for (const ChannelSurvey& channel : found.channels)
    if (!channel.is_known())
      std::cerr << "skipped: " << channel.messages << " messages of an unknown type on "
                << channel.channel << '\n';
    else if (channel.broken > 0)
      std::cerr << "skipped: " << channel.broken << " broken messages on " << channel.channel
                << " (" << channel.type_name() << ")\n";
}

void add_stiffness(CLI::App& command, FollowerOptions& options) {
  add(command, "--stiffness",
      "Young's modulus (Pa) and Poisson's ratio for the stress of the estimate, in place of what "
      "ESTIMATE says",
      options.stiffness);
  add(command, "--truth-stiffness",
      "The same for the stress of the true shape (Neo-Hookean), which no log contains",
      options.truth_stiffness);
}

}  // namespace palpate::exporting
