#pragma once

#include <string>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::faults {

/// The configuration of recording.hpp with one error in it.
struct Mutation {
  std::string what, key, text;
  bool must_fail = true;  // false: it may turn out to be right
};
Mutation mutate_configuration(math::Random& random, const std::vector<std::string>& overrides);

/// Whether a complaint of the file mutated.yaml names its line, and the key where that is what is
/// wrong.
bool names_its_place(const Mutation& mutation, const std::string& complaint);

}  // namespace palpate::faults
