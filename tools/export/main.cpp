#include <iostream>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/common/program.hpp"
#include "tools/export/commands.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app(
      "Turns LCM logs of palpate into CSV, MCAP, VTU, plots, pictures, films and other logs, "
      "without a display.\n"
      "Several logs are merged by time; unknown types are named, counted and skipped; of a "
      "damaged\n"
      "log all that is whole is read, and what is not is reported with its place.");
  app.footer(
      "Examples:\n"
      "  palpate-export info control.log housekeeping.log\n"
      "  palpate-export csv control.log --channel FT_WRENCH 'BIOTAC_*' --output out\n"
      "  palpate-export plot control.log --field 'FT_WRENCH.wrench[0:3]' -o force.png\n"
      "  palpate-export mcap control.log housekeeping.log --output run.mcap\n"
      "  palpate-export vtu housekeeping.log --rate 20 --output out\n"
      "  palpate-export png housekeeping.log --at 2.5 --colour stress --output shape.png\n"
      "  palpate-export mp4 control.log housekeeping.log --colour deviation --output run.mp4\n"
      "  palpate-export merge control.log housekeeping.log --output run.log\n"
      "  palpate-export cut run.log --from 10 --to 20 --output part.log\n"
      "  palpate-export filter run.log --without 'PICTURE*' --output small.log");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.require_subcommand(1);
  std::function<void()> chosen;
  exporting::add_info(app, chosen);
  exporting::add_csv(app, chosen);
  exporting::add_plot(app, chosen);
  exporting::add_mcap(app, chosen);
  exporting::add_vtu(app, chosen);
  exporting::add_png(app, chosen);
  exporting::add_mp4(app, chosen);
  exporting::add_merge(app, chosen);
  exporting::add_cut(app, chosen);
  exporting::add_filter(app, chosen);
  if (const auto code = config::parse(
          app, argc, argv,
          {{{1, "a log cannot be read or nothing can be written"}, {78, "wrong configuration"}},
           {{"--configuration", "--config"}}}))
    return *code;
  return common::run_program("palpate-export", [&] {
    chosen();
    return 0;
  });
}
