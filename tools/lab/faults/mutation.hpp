#pragma once

#include <string>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::faults {

/// The configuration of recording.hpp with one injected error.
struct Mutation {
  std::string what, key, text;
  bool must_fail = true;  // false: it may turn out to be valid
};
Mutation mutate_configuration(math::Random& random, const std::vector<std::string>& overrides);

/// Whether a complaint about the file mutated.yaml names the line, and the key if the key is wrong.
bool names_its_place(const Mutation& mutation, const std::string& complaint);

}  // namespace palpate::faults
