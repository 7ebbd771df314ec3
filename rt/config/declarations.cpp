#include "rt/config/declarations.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate::config {
namespace {

thread_local DeclarationList* the_list = nullptr;

}  // namespace

DeclarationList::DeclarationList() {
  if (the_list != nullptr) throw std::logic_error("a list of declarations is being made already");
  the_list = this;
}

DeclarationList::~DeclarationList() { the_list = nullptr; }

DeclarationList* DeclarationList::current() { return the_list; }

void DeclarationList::add(Declaration declaration) {
  if (Declaration* known = find(declaration.document, declaration.path, declaration.name)) {
    // The same key read again, e.g. by a getter without a default on behalf of one with a default.
    // The reader that knows the meaning declares it.
    if (known->meaning.empty()) known->meaning = declaration.meaning;
    if (known->unit.empty()) known->unit = declaration.unit;
    return;
  }
  declarations_.push_back(std::move(declaration));
}

Declaration* DeclarationList::find(const std::string& document, const std::string& path,
                                   const std::string& name) {
  const auto found =
      std::find_if(declarations_.begin(), declarations_.end(), [&](const Declaration& other) {
        return other.name == name && other.path == path && other.document == document;
      });
  return found == declarations_.end() ? nullptr : &*found;
}

}  // namespace palpate::config
