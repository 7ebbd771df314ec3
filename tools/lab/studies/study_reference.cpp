#include "tools/lab/studies/study_reference.hpp"

#include "tools/lab/studies/study_plan.hpp"
#include "tools/reference/catalogue.hpp"
#include "tools/reference/markdown.hpp"

namespace palpate::studies {
namespace {

constexpr const char* kHead =
    "# Plans of palpate-evaluate\n\n"
    "Printed by `palpate-evaluate reference` from the declarations in the code; do not edit.\n"
    "Plans of `palpate-evaluate thesis`, `control`, `estimate` and the others that take `--plan`.\n"
    "Files are named relative to palpate's own folder. NAME stands for the name of a method or a\n"
    "model error.\n\n";

/// Plans that together use every key.
constexpr const char* kPlans[] = {"thesis.yaml", "control.yaml", "published_control.yaml",
                                  "drawn_sensing.yaml", "drawn_control.yaml"};

}  // namespace

StudyReferenceCommand::StudyReferenceCommand(CLI::App& app)
    : command_(app.add_subcommand("reference", "every key of study plans, as Markdown")) {
  command_->add_option("plans", plans_, "only the keys that these plans use")
      ->check(CLI::ExistingFile);
}

std::optional<int> StudyReferenceCommand::run(const std::filesystem::path& root,
                                              std::ostream& out) const {
  if (!command_->parsed()) return std::nullopt;
  std::vector<std::string> plans = plans_;
  if (plans.empty())
    for (const char* plan : kPlans) plans.push_back((root / "tools/lab/studies" / plan).string());
  std::vector<reference::Declarations> readings;
  for (const std::string& plan : plans)
    readings.push_back(reference::declared_by(plan, [&] { read_study_plan(plan, root); }));
  out << kHead;
  return reference::write_tables(out, readings, 2) ? 0 : 1;
}

}  // namespace palpate::studies
