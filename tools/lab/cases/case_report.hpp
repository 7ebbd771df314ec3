#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <vector>

#include "tools/lab/cases/case_score.hpp"

namespace palpate::cases {

/// "linear" or "quadratic".
const char* name_of(mesh::ElementOrder order);

/// One line per score; those of a dynamic run have more columns.
void print_cases(const std::vector<CaseScore>& scores, std::ostream& out);

/// Lengths in m, forces in N, times in us unless the key states otherwise.
nlohmann::json to_json(const CaseScore& score);

}  // namespace palpate::cases
