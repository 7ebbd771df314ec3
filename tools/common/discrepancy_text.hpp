#pragma once

#include <palpate/discrepancy_t.hpp>
#include <string>

namespace palpate::common {

/// Number of ranked explanations of a message whatever its sender wrote: 0 to 8.
int explanation_count(const discrepancy_t& message);

/// Explanation `rank`, 0 to explanation_count() - 1, with its size and place in O, as "external
/// contact near (0.210, 0.000, 0.030) m, 1.20 N".
std::string explanation_text(const discrepancy_t& message, int rank);

/// Name of discrepancy_t::CAUSE_...; "none of the known causes" for CAUSE_UNKNOWN and all others.
const char* cause_text(int cause);

/// Component of the wrenches that differs most, as "force of hand 0 along z".
std::string component_text(const discrepancy_t& message);

}  // namespace palpate::common
