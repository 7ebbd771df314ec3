#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate::config {

/// Closed range of a number.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

using OptionValue = std::variant<double, int, bool, std::string, std::vector<double>>;

/// Configuration key of a component, independent of what reads it: the configuration reader, the
/// reference, the JSON Schema and plug-ins all use this declaration.
struct Option {
  enum class Kind { kNumber, kInteger, kFlag, kChoice, kNumbers, kFile };

  Kind kind = Kind::kNumber;
  std::string key;
  std::string unit;         // of the configured value; "": dimensionless
  std::string description;  // noun, then effect
  Range range;              // of each number
  int count = 1;            // length, for kNumbers; -1: any
  std::vector<std::string> choices;
  OptionValue otherwise;  // value of an absent key, in `unit`
  bool required = false;  // an absent key is an error
  bool optional = false;  // an absent key has no value: the member keeps its default
  std::vector<std::string> aliases = {};  // former names, accepted with a warning
};

/// The keys of a component and the members of its `Options` that they set. A member is named by a
/// pointer to it or, where it is nested, by a function from Options& to a reference. `scale`
/// multiplies the configured value to give the member's SI unit (1e-3 for a key in ms). An absent
/// key means the member's default.
///   OptionTable<Options>()
///       .number("fade_ms", "ms", "Time constant ...", {1, 1e4}, &Options::fade, 1e-3)
///       .flag("is_repaired", "Repair of ...", &Options::is_repaired);
template <class Options>
class OptionTable {
 public:
  struct Entry {
    Option option;
    std::function<void(Options&, const OptionValue&)> assign;
  };

  explicit OptionTable(Options defaults = {}) : defaults_(std::move(defaults)) {}

  template <class Member>
  OptionTable& number(std::string key, std::string unit, std::string description, Range range,
                      Member member, double scale = 1) {
    const double otherwise = std::invoke(member, defaults_) * (1 / scale);
    return add({Option::Kind::kNumber,
                std::move(key),
                std::move(unit),
                std::move(description),
                range,
                1,
                {},
                otherwise,
                false},
               [member, scale](Options& options, const OptionValue& value) {
                 std::invoke(member, options) = std::get<double>(value) * scale;
               });
  }

  template <class Member>
  OptionTable& integer(std::string key, std::string description, Range range, Member member) {
    const int otherwise = std::invoke(member, defaults_);
    return add({Option::Kind::kInteger,
                std::move(key),
                "",
                std::move(description),
                range,
                1,
                {},
                otherwise,
                false},
               [member](Options& options, const OptionValue& value) {
                 std::invoke(member, options) = std::get<int>(value);
               });
  }

  template <class Member>
  OptionTable& flag(std::string key, std::string description, Member member) {
    const bool otherwise = std::invoke(member, defaults_);
    return add({Option::Kind::kFlag,
                std::move(key),
                "",
                std::move(description),
                {},
                1,
                {},
                otherwise,
                false},
               [member](Options& options, const OptionValue& value) {
                 std::invoke(member, options) = std::get<bool>(value);
               });
  }

  /// `choices`: names and the member's values. The default must be among them.
  template <class Value, class Member>
  OptionTable& choice(std::string key, std::string description,
                      std::vector<std::pair<std::string, Value>> choices, Member member) {
    std::vector<std::string> names;
    std::string otherwise;
    for (const auto& [name, value] : choices) {
      names.push_back(name);
      if (value == std::invoke(member, defaults_)) otherwise = name;
    }
    return add({Option::Kind::kChoice,
                std::move(key),
                "",
                std::move(description),
                {},
                1,
                std::move(names),
                otherwise,
                false},
               [member, choices = std::move(choices)](Options& options, const OptionValue& value) {
                 for (const auto& [name, chosen] : choices)
                   if (name == std::get<std::string>(value)) std::invoke(member, options) = chosen;
               });
  }

  template <class Member>
  OptionTable& vector3(std::string key, std::string unit, std::string description, Range range,
                       Member member) {
    const Eigen::Vector3d otherwise = std::invoke(member, defaults_);
    return add({Option::Kind::kNumbers,
                std::move(key),
                std::move(unit),
                std::move(description),
                range,
                3,
                {},
                std::vector<double>(otherwise.data(), otherwise.data() + 3),
                false},
               [member](Options& options, const OptionValue& value) {
                 const auto& numbers = std::get<std::vector<double>>(value);
                 std::invoke(member, options) = Eigen::Vector3d(numbers.data());
               });
  }

  /// `count`: length of the list; -1: any.
  template <class Member>
  OptionTable& numbers(std::string key, std::string unit, std::string description, Range range,
                       int count, Member member) {
    const std::vector<double> otherwise = std::invoke(member, defaults_);
    return add({Option::Kind::kNumbers,
                std::move(key),
                std::move(unit),
                std::move(description),
                range,
                count,
                {},
                otherwise,
                false},
               [member](Options& options, const OptionValue& value) {
                 std::invoke(member, options) = std::get<std::vector<double>>(value);
               });
  }

  /// Path of a file, relative to the configuration that names it.
  template <class Member>
  OptionTable& file(std::string key, std::string description, Member member) {
    const std::string otherwise = std::invoke(member, defaults_);
    return add({Option::Kind::kFile,
                std::move(key),
                "",
                std::move(description),
                {},
                1,
                {},
                otherwise,
                false},
               [member](Options& options, const OptionValue& value) {
                 std::invoke(member, options) = std::get<std::string>(value);
               });
  }

  /// Makes the option declared last mandatory.
  OptionTable& required() {
    entries_.back().option.required = true;
    return *this;
  }

  /// Lets an absent key of the option declared last have no value: the member keeps its default,
  /// which means that there is none, and the reference shows no default.
  OptionTable& optional() {
    entries_.back().option.optional = true;
    return *this;
  }

  /// Accepts `former`, the previous name of the option declared last. The reader warns of it; the
  /// reference and the schema do not show it.
  OptionTable& alias(std::string former) {
    entries_.back().option.aliases.push_back(std::move(former));
    return *this;
  }

  /// Appends the keys of another table of the same options.
  OptionTable& part(const OptionTable& table) {
    entries_.insert(entries_.end(), table.entries_.begin(), table.entries_.end());
    return *this;
  }

  /// Appends the keys of another table, whose options are a member of these.
  template <class Part, class Member>
  OptionTable& part(const OptionTable<Part>& table, Member member) {
    for (const auto& entry : table.entries())
      add(entry.option,
          [member, assign = entry.assign](Options& options, const OptionValue& value) {
            assign(std::invoke(member, options), value);
          });
    return *this;
  }

  /// The options for one value per entry, in the order of the entries.
  Options make(const std::vector<OptionValue>& values) const {
    Options options = defaults_;
    for (std::size_t i = 0; i < entries_.size(); ++i) entries_[i].assign(options, values.at(i));
    return options;
  }

  const std::vector<Entry>& entries() const { return entries_; }
  const Options& defaults() const { return defaults_; }

 private:
  OptionTable& add(Option option, std::function<void(Options&, const OptionValue&)> assign) {
    entries_.push_back({std::move(option), std::move(assign)});
    return *this;
  }

  Options defaults_;
  std::vector<Entry> entries_;
};

}  // namespace palpate::config
