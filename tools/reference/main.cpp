// palpate-reference: every parameter, from the declarations in the code that reads it.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <tuple>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/fit/kinds.hpp"
#include "tools/reference/catalogue.hpp"
#include "tools/reference/exploration.hpp"

namespace {

using namespace palpate;
using namespace palpate::reference;

constexpr const char* kHead =
    "# Configuration\n\n"
    "Made by `palpate-reference` from the declarations in the code that reads them; do not edit.\n"
    "SI units throughout. A key that is not read is an error, which names file, line, key and "
    "what\n"
    "is allowed. `base: FILE` at the top puts a file's entries over those of another (an\n"
    "empty entry, `key: ~`, takes away what is there) and `--set path.to.key=value` over both. A "
    "pose is `{position: [x, y, z], quaternion: [w, x, y, "
    "z]}`\n"
    "or `{position: ..., rpy_deg: [r, p, y]}`; files are named relative to the file that names "
    "them.\n"
    "What stands in parentheses before a meaning says with which other choices a key is read.\n"
    "`palpate-reference your.yaml` prints the same for the parts that one configuration uses.\n\n";

constexpr const char* kDaemon =
    "## palpated\n\n"
    "A section of `sensing`, `contact`, `estimation`, `deformation`, `feature` or `control` may "
    "have\n"
    "a section `fallback`, as its slot's own, which takes its place where the component errs.\n"
    "Sections of `second_arm` that are not listed are as those of the first arm.\n\n";

constexpr const char* kFit =
    "## Plans of palpate-fit\n\n"
    "`recording`, laid under every recording, and each entry of `recordings` hold what the next\n"
    "chapter describes. NAME is that of a parameter.\n\n";

constexpr const char* kRecording =
    "## Recordings of palpate-fit\n\n"
    "Each by its `kind`. A number with unit is one in SI, `0.0105`, or one with a unit of its "
    "own,\n"
    "`10.5 mm`; its range is in SI. QUANTITY is each of those that `columns` names.\n\n";

/// One table per kind of recording: they have little in common.
bool write_recordings(std::ostream& out, const std::filesystem::path& models) {
  const std::vector<Exploration> all = explorations(Reader::kRecording, models);
  bool is_complete = true;
  for (const fit::Kind& kind : fit::kinds()) {
    std::vector<Declarations> readings;
    for (const Exploration& exploration : all)
      if (exploration.kind == kind.name) readings.push_back(read(Reader::kRecording, exploration));
    out << "### Kind `" << kind.name << "`: " << kind.summary << "\n\n";
    is_complete = write_tables(out, readings, 4) && is_complete && !readings.empty();
  }
  return is_complete;
}

bool write_all(std::ostream& out) {
  const common::TemporaryFolder models("palpate-reference");
  out << kHead;
  bool is_complete = true;
  const std::pair<Reader, const char*> chapters[] = {
      {Reader::kDaemon, kDaemon},
      {Reader::kScene, "## Scenes of palpate-sim\n\n"},
      {Reader::kTrain, "## Plans of palpate-train\n\n"},
      {Reader::kFit, kFit},
      {Reader::kRecording, kRecording}};
  for (const auto& [reader, title] : chapters) {
    out << title;
    if (reader == Reader::kRecording) {
      is_complete = write_recordings(out, models.path()) && is_complete;
      continue;
    }
    std::vector<Declarations> readings;
    for (const Exploration& exploration : explorations(reader, models.path()))
      readings.push_back(read(reader, exploration));
    is_complete = write_tables(out, readings, 3) && is_complete;
  }
  return is_complete;
}

int run(const std::string& file, Reader reader, const std::vector<std::string>& overrides) {
  const bool is_complete = file.empty()
                               ? write_all(std::cout)
                               : write_tables(std::cout, {read(reader, {file, overrides})}, 2);
  return is_complete ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-reference prints every parameter of configurations, scenes and plans of\n"
      "palpate-train and palpate-fit as a table in Markdown: type, unit, "
      "default, range and meaning, as the code "
      "declares them.");
  std::string file;
  std::vector<std::string> overrides;
  Reader reader = Reader::kDaemon;
  app.add_option("configuration", file,
                 "only what this one is asked for; without it everything there is");
  const std::tuple<const char*, Reader, const char*> kinds[] = {
      {"--scene", Reader::kScene, "it is a scene of palpate-sim"},
      {"--train", Reader::kTrain, "it is a plan of palpate-train"},
      {"--fit", Reader::kFit, "it is a plan of palpate-fit"}};
  CLI::Option_group* kind = app.add_option_group("what the file is", "absent: a configuration");
  for (const auto& [name, of, meaning] : kinds) {
    kind->add_flag_callback(
        name, [&reader, of = of] { reader = of; }, meaning);
  }
  kind->require_option(0, 1);
  app.add_option("--set", overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer("Examples:\n  palpate-reference your.yaml\n  palpate-reference > configuration.md");
  if (const auto code = config::parse(
          app, argc, argv,
          {{{1, "an error, or a parameter without a meaning"}, {78, "wrong configuration"}}}))
    return *code;
  return common::run_program("error", [&] { return run(file, reader, overrides); });
}
