#include "tools/types/type_set.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

namespace palpate::types {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 4 << 20;  // bytes
constexpr int kDeepest = 32;                      // structs within structs that are not recursive

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  if (fs::file_size(path) > kLargestFile)
    throw std::runtime_error(path.string() + ": is larger than 4 MB and no description");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file() && entry.path().extension() == ".lcm")
      files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(path.string() + ": holds no .lcm file");
  std::sort(files.begin(), files.end());
  return files;
}

/// LCM's hash of words: of 64 bits, shifted with the sign.
class Hash {
 public:
  explicit Hash(std::int64_t start) : value_(start) {}
  void add(char c) {
    const auto shifted = static_cast<std::int64_t>(static_cast<std::uint64_t>(value_) << 8);
    value_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted ^ (value_ >> 55)) +
                                       static_cast<std::uint64_t>(static_cast<std::int64_t>(c)));
  }
  void add(const std::string& word) {
    add(static_cast<char>(word.size()));
    for (const char c : word) add(c);
  }
  std::uint64_t value() const { return static_cast<std::uint64_t>(value_); }

 private:
  std::int64_t value_;
};

std::uint64_t hash_of_enumeration(const std::string& name) {
  Hash hash(0x87654321);
  hash.add(name.substr(name.rfind('.') + 1));
  return hash.value();
}

/// Of the members alone: their names, primitive types and dimensions.
std::uint64_t own_hash(const Struct& type) {
  Hash hash(0x12345678);
  for (const Member& member : type.members) {
    hash.add(member.name);
    if (member.kind < Kind::kEnumeration) hash.add(member.type);
    hash.add(static_cast<char>(member.dimensions.size()));
    for (const Dimension& dimension : member.dimensions) {
      hash.add(static_cast<char>(dimension.member >= 0 ? 1 : 0));
      hash.add(dimension.text);
    }
  }
  return hash.value();
}

std::uint64_t hash_of(const Struct& type, std::vector<const Struct*>& parents) {
  if (std::find(parents.begin(), parents.end(), &type) != parents.end()) return 0;
  if (parents.size() == kDeepest)
    throw std::runtime_error(type.place + ": " + type.name + " lies more than " +
                             std::to_string(kDeepest) + " structs deep in others");
  std::uint64_t hash = own_hash(type);
  parents.push_back(&type);
  // The same struct in several members has the same hash, but counts as often.
  std::map<const Struct*, std::uint64_t> known;
  for (const Member& member : type.members) {
    if (member.kind == Kind::kEnumeration) hash += hash_of_enumeration(member.type);
    if (member.kind != Kind::kStruct) continue;
    const auto [found, is_new] = known.try_emplace(member.content);
    if (is_new) found->second = hash_of(*member.content, parents);
    hash += found->second;
  }
  parents.pop_back();
  return (hash << 1) + (hash >> 63);
}

}  // namespace

TypeSet::TypeSet(const std::vector<fs::path>& paths) {
  std::set<fs::path> read;
  for (const fs::path& path : paths)
    for (const fs::path& file : files_of(path))
      if (read.insert(fs::weakly_canonical(file)).second) add(parse(text_of(file), file.string()));
  resolve();
}

TypeSet::TypeSet(const std::string& text, const std::string& file) {
  add(parse(text, file));
  resolve();
}

void TypeSet::add(Description description) {
  for (Struct& type : description.structs)
    structs_.push_back(std::make_shared<Struct>(std::move(type)));
  for (Enumeration& type : description.enumerations) enumerations_.push_back(std::move(type));
}

void TypeSet::resolve() {
  std::sort(structs_.begin(), structs_.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  std::map<std::string, std::string> places;
  const auto claim = [&places](const std::string& name, const std::string& place) {
    const auto [found, is_new] = places.try_emplace(name, place);
    if (!is_new)
      throw std::runtime_error(place + ": " + name + " is described before, in " + found->second);
  };
  for (const auto& type : structs_) claim(type->name, type->place);
  for (const Enumeration& type : enumerations_) claim(type.name, type.place);
  for (const auto& type : structs_) {
    for (Member& member : type->members) {
      if (member.kind != Kind::kStruct) continue;
      const auto is_it = [&member](const Enumeration& other) { return other.name == member.type; };
      member.content = find(member.type);
      if (member.content != nullptr) continue;
      if (std::none_of(enumerations_.begin(), enumerations_.end(), is_it))
        throw std::runtime_error(type->place + ": " + type->name + "." + member.name +
                                 ": its type " + member.type +
                                 " is in none of the descriptions; name its folder too");
      member.kind = Kind::kEnumeration;
    }
  }
  for (const auto& type : structs_) {
    std::vector<const Struct*> parents;
    type->fingerprint = static_cast<std::int64_t>(hash_of(*type, parents));
    by_fingerprint_.try_emplace(type->fingerprint, type.get());
  }
}

const Struct* TypeSet::find(const std::string& name) const {
  const auto found = std::lower_bound(
      structs_.begin(), structs_.end(), name,
      [](const auto& type, const std::string& other) { return type->name < other; });
  return found != structs_.end() && (*found)->name == name ? found->get() : nullptr;
}

const Struct* TypeSet::type_of(const void* data, int size) const {
  if (size < 8 || by_fingerprint_.empty()) return nullptr;
  std::uint64_t fingerprint = 0;
  for (int i = 0; i < 8; ++i)
    fingerprint = fingerprint << 8 | static_cast<const std::uint8_t*>(data)[i];
  const auto found = by_fingerprint_.find(static_cast<std::int64_t>(fingerprint));
  return found == by_fingerprint_.end() ? nullptr : found->second;
}

void add_types_option(CLI::App& app, std::vector<fs::path>& paths) {
  app.add_option("--types", paths,
                 "folder of .lcm files, or one of them: messages of these types are decoded too "
                 "(repeatable)")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->check(CLI::ExistingPath);
}

}  // namespace palpate::types
