#include "tools/export/shape_options.hpp"

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

void add_stiffness(CLI::App& command, FollowerOptions& options) {
  add(command, "--stiffness",
      "Young's modulus (Pa) and Poisson's ratio for the stress of the estimate, in place of what "
      "ESTIMATE says",
      options.stiffness);
  add(command, "--truth-stiffness",
      "The same for the stress of the true shape (Neo-Hookean), which no log tells",
      options.truth_stiffness);
}

}  // namespace palpate::exporting
