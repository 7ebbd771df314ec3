#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate::plugin {

using ParameterValue = std::variant<double, int, bool, std::string, std::vector<double>>;

/// Configuration key of a plug-in's component. The host reads and validates it; keys that no
/// component declares are an error.
struct Parameter {
  enum class Kind { kNumber, kInteger, kFlag, kChoice, kNumbers };
  Kind kind = Kind::kNumber;
  std::string key;
  std::string description;           // meaning and unit
  double lower = 0, upper = 0;       // permitted closed range of numbers
  int count = 0;                     // length, for kNumbers
  std::vector<std::string> allowed;  // choices, for kChoice
  ParameterValue otherwise;          // value if the key is absent
  bool required = false;             // an absent key is an error
};

/// Each function declares one key; `required()` makes it mandatory.
inline Parameter number(std::string key, double lower, double upper, double otherwise,
                        std::string description) {
  return {Parameter::Kind::kNumber,
          std::move(key),
          std::move(description),
          lower,
          upper,
          1,
          {},
          otherwise,
          false};
}
inline Parameter integer(std::string key, int lower, int upper, int otherwise,
                         std::string description) {
  return {Parameter::Kind::kInteger,
          std::move(key),
          std::move(description),
          static_cast<double>(lower),
          static_cast<double>(upper),
          1,
          {},
          otherwise,
          false};
}
inline Parameter flag(std::string key, bool otherwise, std::string description) {
  return {Parameter::Kind::kFlag,
          std::move(key),
          std::move(description),
          0,
          1,
          1,
          {},
          otherwise,
          false};
}
inline Parameter choice(std::string key, std::vector<std::string> allowed, std::string otherwise,
                        std::string description) {
  return {
      Parameter::Kind::kChoice, std::move(key), std::move(description), 0, 0, 1, std::move(allowed),
      std::move(otherwise),     false};
}
/// The count of numbers is that of `otherwise`.
inline Parameter numbers(std::string key, double lower, double upper, std::vector<double> otherwise,
                         std::string description) {
  const int count = static_cast<int>(otherwise.size());
  return {
      Parameter::Kind::kNumbers, std::move(key), std::move(description), lower, upper, count, {},
      std::move(otherwise),      false};
}
inline Parameter required(Parameter parameter) {
  parameter.required = true;
  return parameter;
}

/// Values of the keys declared by a component, within their ranges. A getter throws
/// std::logic_error for a key that was not declared or has another kind.
class Parameters {
 public:
  void put(const std::string& key, ParameterValue value) { values_[key] = std::move(value); }

  double number(const std::string& key) const { return get<double>(key); }
  int integer(const std::string& key) const { return get<int>(key); }
  bool flag(const std::string& key) const { return get<bool>(key); }
  const std::string& choice(const std::string& key) const { return get<std::string>(key); }
  const std::vector<double>& numbers(const std::string& key) const {
    return get<std::vector<double>>(key);
  }

 private:
  template <class Value>
  const Value& get(const std::string& key) const {
    const auto at = values_.find(key);
    const Value* value = at == values_.end() ? nullptr : std::get_if<Value>(&at->second);
    if (value == nullptr) throw std::logic_error("parameter " + key + " is not declared so");
    return *value;
  }

  std::map<std::string, ParameterValue> values_;
};

}  // namespace palpate::plugin
