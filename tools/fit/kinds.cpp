#include "tools/fit/kinds.hpp"

#include <algorithm>

#include "tools/fit/experiments/ball.hpp"
#include "tools/fit/experiments/beam.hpp"
#include "tools/fit/experiments/skin.hpp"
#include "tools/fit/experiments/uniaxial.hpp"
#include "tools/fit/held/held_decay.hpp"
#include "tools/fit/held/held_object.hpp"

namespace palpate::fit {

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"uniaxial", "a bar in tension or compression: load against strain", make_uniaxial},
      {"hertz", "indentation by a ball: force against depth, Hertz or linear", make_hertz},
      {"indentation", "ball pressed into a layer: force against depth, finite elements",
       make_indentation},
      {"membrane", "skin stretched by pads: field of displacements and force, finite elements",
       make_membrane},
      {"beam", "clamped beam let go under its weight: rest and free oscillation", make_beam},
      {"held_object", "an object in a hand that moves and rests: its wrench, from an LCM log",
       make_held_object},
      {"held_decay", "the same ringing out after a stop of the hand: its damping, from an LCM log",
       make_held_decay},
  };
  return all;
}

std::unique_ptr<Experiment> make_experiment(const config::Node& node,
                                            const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) names.push_back(kind.name);
  const std::string name = node.choice({"kind", "", "of experiment"}, names);
  const auto kind =
      std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.name == name; });
  return kind->make(node, folder);
}

}  // namespace palpate::fit
