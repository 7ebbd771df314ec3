// Configurations with an error.

#include <yaml-cpp/yaml.h>

#include <regex>

#include "tools/lab/faults/mutation.hpp"
#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {
namespace {

/// Paths to every value that is not a mapping, and to every mapping.
struct Places {
  std::vector<std::vector<std::string>> values, mappings;
};

void collect(const YAML::Node& node, std::vector<std::string> path, Places& places) {
  if (!node.IsMap()) {
    places.values.push_back(path);
    return;
  }
  places.mappings.push_back(path);
  for (const auto& entry : node) {
    std::vector<std::string> below = path;
    below.push_back(entry.first.as<std::string>());
    collect(entry.second, below, places);
  }
}

YAML::Node at(YAML::Node root, const std::vector<std::string>& path, std::size_t depth = 0) {
  return depth == path.size() ? root : at(root[path[depth]], path, depth + 1);
}

std::string file_of(const YAML::Node& node) {
  YAML::Emitter out;
  out.SetMapFormat(YAML::Block);
  out << node;
  return out.c_str();
}

}  // namespace

Mutation mutate_configuration(math::Random& random, const std::vector<std::string>& overrides) {
  YAML::Node root = YAML::Load(configuration(overrides).dump());
  Places places;
  collect(root, {}, places);
  Mutation mutation;
  const auto choose = [&random](const auto& list) { return list[random.below(list.size())]; };
  switch (random.below(4)) {
    case 0: {
      const std::vector<std::string> path = choose(places.mappings);
      mutation.what = "unknown key";
      mutation.key = "no_such_key";
      at(root, path)[mutation.key] = 1;
      break;
    }
    case 1: {
      const std::vector<std::string> path = choose(places.values);
      mutation.what = "wrong type";
      mutation.key = path.back();
      YAML::Node wrong;
      wrong["no"]["such"] = "thing";
      at(root, path) = wrong;
      break;
    }
    case 2: {
      const std::vector<std::string> path = choose(places.values);
      constexpr const char* kWrong[] = {".nan", "1e300", "-1e300", "twelve", "''"};
      mutation.what = "value out of range";
      mutation.key = path.back();
      // A text may be any word, and a number may be large if it has no bound.
      mutation.must_fail = false;
      at(root, path) = YAML::Load(kWrong[random.below(5)]);
      break;
    }
    default: {
      std::vector<std::string> path = choose(places.values);
      mutation.what = "missing key";
      mutation.key = path.back();
      mutation.must_fail = false;  // many have a default
      path.pop_back();
      at(root, path).remove(mutation.key);
    }
  }
  mutation.text = file_of(root);
  return mutation;
}

bool names_its_place(const Mutation& mutation, const std::string& complaint) {
  static const std::regex kPlace("mutated\\.yaml:[0-9]+: ");
  const bool by_key = mutation.what == "wrong type" || mutation.what == "unknown key";
  return std::regex_search(complaint, kPlace) &&
         (!by_key || complaint.find(mutation.key) != std::string::npos);
}

namespace {

/// Rejected with file, line and key, or accepted if it is valid after all; nothing else is
/// permitted.
RunResult run_mutated(const Bench&, std::uint64_t seed) {
  math::Random random(seed, "configuration");
  RunResult result;
  result.measured = 0;
  constexpr int kMutations = 20;
  for (int i = 0; i < kMutations; ++i) {
    const Mutation mutation = mutate_configuration(random, {});
    const std::string where = mutation.what + " " + mutation.key + ": ";
    try {
      const auto hub = bus::make_memory_hub();
      const auto bus = bus::make_memory_bus(hub);
      const config::Node root = config::Node::from_text(mutation.text, "mutated.yaml");
      const daemon::Daemon daemon(root, *bus, *bus, daemon::Mode::kDeterministic, 1);
      if (mutation.must_fail) result.fail(where + "is taken");
    } catch (const config::Error& error) {
      if (!names_its_place(mutation, error.what())) {
        ++result.measured;
        result.note(where + error.what());
      }
      result.outcome = std::max(result.outcome, Outcome::kSafeStop);
    } catch (const std::exception& error) {
      result.fail(where + "another exception: " + error.what());
    }
  }
  return result;
}

}  // namespace

std::vector<Row> configuration_rows() {
  return {{"21", "20 errors in the configuration", "rejected with file, line and key", "unnamed", 0,
           false, run_mutated}};
}

}  // namespace palpate::faults
