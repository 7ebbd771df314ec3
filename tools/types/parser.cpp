#include "tools/types/parser.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>

#include "tools/types/tokens.hpp"

namespace palpate::types {
namespace {

constexpr std::size_t kMostDimensions = 8;

const std::map<std::string, Kind>& primitives() {
  static const std::map<std::string, Kind> kPrimitives = {
      {"int8_t", Kind::kInt8},   {"int16_t", Kind::kInt16}, {"int32_t", Kind::kInt32},
      {"int64_t", Kind::kInt64}, {"byte", Kind::kByte},     {"boolean", Kind::kBoolean},
      {"float", Kind::kFloat},   {"double", Kind::kDouble}, {"string", Kind::kString}};
  return kPrimitives;
}

bool is_integer(Kind kind) { return kind <= Kind::kInt64; }

bool is_name(const std::string& text, bool with_dots) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0) return false;
  return std::all_of(text.begin(), text.end(), [with_dots](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || (with_dots && c == '.');
  });
}

class Parser {
 public:
  Parser(const std::string& text, std::string file) : tokens_(text, std::move(file)) {}

  Description parse() {
    while (!tokens_.at_end()) {
      if (tokens_.accept("package")) {
        package_ = name("a package", true);
        tokens_.expect(";");
      } else if (tokens_.accept("struct")) {
        result_.structs.push_back(structure());
      } else if (tokens_.accept("enum")) {
        result_.enumerations.push_back(enumeration());
      } else if (!tokens_.accept(";")) {  // after a closing brace, as in C
        tokens_.fail("'" + tokens_.peek() + "' is none of package, struct and enum");
      }
    }
    return std::move(result_);
  }

 private:
  std::string name(const std::string& what, bool with_dots = false) {
    if (!is_name(tokens_.peek(), with_dots))
      tokens_.fail("'" + tokens_.peek() + "' cannot be the name of " + what);
    return tokens_.take();
  }

  std::string qualified(const std::string& type) const {
    const bool is_complete =
        package_.empty() || type.find('.') != std::string::npos || primitives().count(type) > 0;
    return is_complete ? type : package_ + "." + type;
  }

  Struct structure() {
    Struct type;
    type.place = tokens_.place();
    type.comment = tokens_.comment();
    type.name = qualified(name("a struct"));
    tokens_.expect("{");
    while (!tokens_.accept("}")) {
      if (tokens_.accept("const"))
        constants(type);
      else
        members(type);
    }
    return type;
  }

  Enumeration enumeration() {
    Enumeration type;
    type.place = tokens_.place();
    type.name = qualified(name("an enum"));
    tokens_.expect("{");
    std::int32_t largest = 0;
    while (!tokens_.accept("}")) {
      const std::string entry = name("a value of an enum");
      const auto value = static_cast<std::int32_t>(
          tokens_.accept("=") ? integer(std::numeric_limits<std::int32_t>::min(),
                                        std::numeric_limits<std::int32_t>::max())
                              : std::int64_t{largest} + 1);
      largest = std::max(largest, value);
      type.values.emplace_back(entry, value);
      while (tokens_.accept(",") || tokens_.accept(";")) {
      }
    }
    return type;
  }

  std::int64_t integer(std::int64_t least, std::int64_t greatest) {
    const std::string text = tokens_.peek();
    char* end = nullptr;
    errno = 0;
    const long long value = std::strtoll(text.c_str(), &end, 0);
    if (text.empty() || *end != '\0' || errno != 0 || value < least || value > greatest)
      tokens_.fail("'" + text + "' is no integer from " + std::to_string(least) + " to " +
                   std::to_string(greatest));
    tokens_.take();
    return value;
  }

  void require_new(const Struct& type, const std::string& entry) const {
    const auto same = [&entry](const auto& other) { return other.name == entry; };
    if (std::any_of(type.members.begin(), type.members.end(), same) ||
        std::any_of(type.constants.begin(), type.constants.end(), same))
      tokens_.fail(type.name + " has '" + entry + "' twice");
  }

  void constants(Struct& type) {
    Kind kind{};
    const std::string primitive = tokens_.peek();
    if (!is_primitive(primitive, kind) ||
        !(is_integer(kind) || kind == Kind::kFloat || kind == Kind::kDouble))
      tokens_.fail("a constant cannot be of type '" + primitive + "'");
    tokens_.take();
    do {
      Constant constant{primitive, name("a constant"), ""};
      require_new(type, constant.name);
      tokens_.expect("=");
      constant.value = tokens_.peek();
      if (is_integer(kind)) {
        const int bits = 8 * size_of(kind);
        const auto greatest = static_cast<std::int64_t>((std::uint64_t{1} << (bits - 1)) - 1);
        integer(-greatest - 1, greatest);
      } else {
        char* end = nullptr;
        std::strtod(constant.value.c_str(), &end);
        if (constant.value.empty() || *end != '\0')
          tokens_.fail("'" + constant.value + "' is no number");
        tokens_.take();
      }
      type.constants.push_back(constant);
    } while (tokens_.accept(","));
    tokens_.expect(";");
  }

  void members(Struct& type) {
    const std::string written = name("a type", true);
    if (written == "struct" || written == "enum")
      tokens_.fail("types inside of structs are not possible in LCM");
    Member declared;
    declared.kind = Kind::kStruct;
    is_primitive(written, declared.kind);
    declared.type = qualified(written);
    const std::size_t first = type.members.size();
    do {
      Member member = declared;
      member.name = name("a member");
      require_new(type, member.name);
      while (tokens_.accept("[")) member.dimensions.push_back(dimension(type, member));
      type.members.push_back(std::move(member));
    } while (tokens_.accept(","));
    const std::string comment = tokens_.comment();
    tokens_.expect(";");
    for (std::size_t i = first; i < type.members.size(); ++i) type.members[i].comment = comment;
  }

  Dimension dimension(const Struct& type, const Member& member) {
    if (member.dimensions.size() == kMostDimensions)
      tokens_.fail(member.name + " has more than " + std::to_string(kMostDimensions) +
                   " dimensions");
    Dimension result;
    result.text = tokens_.peek();
    if (is_name(result.text, false)) {
      tokens_.take();
      resolve(type, result);
    } else {
      result.size = static_cast<int>(integer(1, std::numeric_limits<int>::max()));
    }
    tokens_.expect("]");
    return result;
  }

  void resolve(const Struct& type, Dimension& dimension) const {
    for (const Constant& constant : type.constants) {
      if (constant.name != dimension.text) continue;
      const long long size = std::strtoll(constant.value.c_str(), nullptr, 0);
      if (primitives().at(constant.type) > Kind::kInt64 || size < 1 ||
          size > std::numeric_limits<int>::max())
        tokens_.fail("the constant " + constant.name + " = " + constant.value +
                     " cannot be an array's size");
      dimension.text = constant.value;
      dimension.size = static_cast<int>(size);
      return;
    }
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      const Member& member = type.members[i];
      if (member.name != dimension.text) continue;
      if (!is_integer(member.kind) || !member.dimensions.empty())
        tokens_.fail("'" + member.name + "' cannot be an array's size: it is no single integer");
      dimension.member = static_cast<int>(i);
      return;
    }
    tokens_.fail("the array's size '" + dimension.text +
                 "' is neither a constant nor a member before it");
  }

  Tokens tokens_;
  std::string package_;
  Description result_;
};

}  // namespace

int size_of(Kind kind) {
  switch (kind) {
    case Kind::kInt8:
    case Kind::kByte:
    case Kind::kBoolean:
      return 1;
    case Kind::kInt16:
      return 2;
    case Kind::kInt32:
    case Kind::kFloat:
    case Kind::kEnumeration:
      return 4;
    case Kind::kInt64:
    case Kind::kDouble:
      return 8;
    case Kind::kString:
    case Kind::kStruct:
      break;
  }
  return 0;
}

bool is_primitive(const std::string& name, Kind& kind) {
  const auto found = primitives().find(name);
  if (found == primitives().end()) return false;
  kind = found->second;
  return true;
}

Description parse(const std::string& text, const std::string& file) {
  return Parser(text, file).parse();
}

}  // namespace palpate::types
