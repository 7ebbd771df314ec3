#pragma once

#include <iosfwd>
#include <vector>

#include "tools/reference/catalogue.hpp"

namespace palpate::reference {

/// One table per section, its heading at `level`.
void write_markdown(std::ostream& out, const std::vector<Section>& sections, int level);

/// One table per section of all readings together. Returns false, and names the key on standard
/// error, if a declaration has no description.
bool write_tables(std::ostream& out, const std::vector<Declarations>& readings, int level);

}  // namespace palpate::reference
