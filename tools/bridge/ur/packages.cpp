#include "packages.hpp"

#include <array>
#include <sstream>
#include <utility>

namespace palpate::ur_bridge {

void PackageWriter::begin(PackageType type) {
  bytes_.assign({0, 0, static_cast<std::uint8_t>(type)});
}

PackageWriter& PackageWriter::put_text(const std::string& text) {
  bytes_.insert(bytes_.end(), text.begin(), text.end());
  return *this;
}

const std::vector<std::uint8_t>& PackageWriter::finish() {
  bytes_[0] = static_cast<std::uint8_t>(bytes_.size() >> 8);
  bytes_[1] = static_cast<std::uint8_t>(bytes_.size());
  return bytes_;
}

std::string PackageReader::get_text(int size) {
  if (size < 0) size = remaining();
  if (size > remaining()) {
    is_ok_ = false;
    size = remaining();
  }
  std::string text(reinterpret_cast<const char*>(data_), static_cast<std::size_t>(size));
  data_ += size;
  return text;
}

int size_of(const std::string& type) {
  constexpr std::array<std::pair<const char*, int>, 10> kSizes{{{"BOOL", 1},
                                                                {"UINT8", 1},
                                                                {"UINT32", 4},
                                                                {"UINT64", 8},
                                                                {"INT32", 4},
                                                                {"DOUBLE", 8},
                                                                {"VECTOR3D", 24},
                                                                {"VECTOR6D", 48},
                                                                {"VECTOR6INT32", 24},
                                                                {"VECTOR6UINT32", 24}}};
  for (const auto& [name, size] : kSizes)
    if (type == name) return size;
  return 0;
}

int size_of(const std::vector<Variable>& variables) {
  int size = 0;
  for (const Variable& variable : variables) size += size_of(variable.type);
  return size;
}

std::string names_of(const std::vector<Variable>& variables) {
  std::string names;
  for (const Variable& variable : variables) names += (names.empty() ? "" : ",") + variable.name;
  return names;
}

std::string difference_of(const std::vector<Variable>& variables, const std::string& types) {
  std::istringstream answered(types);
  for (const Variable& variable : variables) {
    std::string type;
    if (!std::getline(answered, type, ',')) return "no type of " + variable.name + " is answered";
    if (type == "NOT_FOUND") return "it has no " + variable.name;
    if (type == "IN_USE") return variable.name + " is in use by another program";
    if (type != variable.type)
      return variable.name + " is of type " + type + "; allowed: " + variable.type;
  }
  std::string more;
  if (std::getline(answered, more)) return "more types are answered than variables were asked for";
  return "";
}

}  // namespace palpate::ur_bridge
