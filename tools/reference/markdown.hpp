#pragma once

#include <iosfwd>
#include <vector>

#include "tools/reference/catalogue.hpp"

namespace palpate::reference {

/// One table a section, its heading at `level`.
void write_markdown(std::ostream& out, const std::vector<Section>& sections, int level);

/// One table a section of all readings together. False, and named on standard error, where a
/// declaration has no description.
bool write_tables(std::ostream& out, const std::vector<Declarations>& readings, int level);

}  // namespace palpate::reference
