#pragma once

#include <string>

namespace palpate::import {

/// What palpate-import reads, in Markdown: a table of fields, unit, whether required and effect for
/// each of format_names(), from the table that the import itself goes by. It is docs/import.md.
std::string formats_page();

}  // namespace palpate::import
