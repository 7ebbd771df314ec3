#pragma once

#include <string>
#include <vector>

namespace palpate::config {

/// One parameter as its reader declares it.
struct Declaration {
  std::string document;  // name of the file that was read
  std::string path;      // of the mapping that the key is in; items of lists by number
  std::string name;
  std::string type;     // number, whole number, flag, text, file, one of, section, ...
  std::string unit;     // "": none
  std::string meaning;  // "": not told
  std::string allowed;  // range or choices; "": anything of the type
  std::string
      fallback;  // what an absent key means, as YAML; "" where it must be there, or a section
  bool required = false;
  bool present = false;  // in the document that was read
  std::string value;     // of a choice, as read
};

/// While it lives, everything that this thread asks of any Node is listed, each key of a document
/// once. One at a time.
class DeclarationList {
 public:
  DeclarationList();
  ~DeclarationList();
  DeclarationList(const DeclarationList&) = delete;
  DeclarationList& operator=(const DeclarationList&) = delete;

  const std::vector<Declaration>& all() const { return declarations_; }

  /// The list that is being made by this thread; nullptr: none is.
  static DeclarationList* current();
  void add(Declaration declaration);
  /// What it has of this key; nullptr: nothing.
  Declaration* find(const std::string& document, const std::string& path, const std::string& name);

 private:
  std::vector<Declaration> declarations_;
};

}  // namespace palpate::config
