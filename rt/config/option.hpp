#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <stdexcept>
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
  Range range = {};         // of each number
  int count = 1;            // length, for kNumbers; -1: any
  std::vector<std::string> choices = {};
  OptionValue otherwise = {};  // value of an absent key, in `unit`
  bool required = false;       // an absent key is an error
  bool optional = false;       // an absent key has no value: the member keeps its default
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
  OptionTable& number(const std::string& key, const std::string& unit,
                      const std::string& description, Range range, Member member,
                      double scale = 1) {
    const double otherwise = std::invoke(member, defaults_) * (1 / scale);
    return declare<double>({Option::Kind::kNumber, key, unit, description, range}, otherwise,
                           member, [scale](double value) { return value * scale; });
  }

  template <class Member>
  OptionTable& integer(const std::string& key, const std::string& description, Range range,
                       Member member) {
    return declare<int>({Option::Kind::kInteger, key, "", description, range},
                        std::invoke(member, defaults_), member);
  }

  template <class Member>
  OptionTable& flag(const std::string& key, const std::string& description, Member member) {
    return declare<bool>({Option::Kind::kFlag, key, "", description},
                         std::invoke(member, defaults_), member);
  }

  /// `choices`: names and the member's values. The default must be among them.
  template <class Value, class Member>
  OptionTable& choice(const std::string& key, const std::string& description,
                      std::vector<std::pair<std::string, Value>> choices, Member member) {
    Option option{Option::Kind::kChoice, key, "", description};
    std::string otherwise;
    for (const auto& [name, value] : choices) {
      option.choices.push_back(name);
      if (value == std::invoke(member, defaults_)) otherwise = name;
    }
    auto value_of = [choices = std::move(choices)](const std::string& given) {
      for (const auto& [name, value] : choices)
        if (name == given) return value;
      throw std::out_of_range(given + ": not among the choices");
    };
    return declare<std::string>(std::move(option), otherwise, member, std::move(value_of));
  }

  template <class Member>
  OptionTable& vector3(const std::string& key, const std::string& unit,
                       const std::string& description, Range range, Member member) {
    const Eigen::Vector3d otherwise = std::invoke(member, defaults_);
    return declare<std::vector<double>>(
        {Option::Kind::kNumbers, key, unit, description, range, 3},
        {otherwise.data(), otherwise.data() + 3}, member,
        [](const std::vector<double>& numbers) { return Eigen::Vector3d(numbers.data()); });
  }

  /// `count`: length of the list; -1: any.
  template <class Member>
  OptionTable& numbers(const std::string& key, const std::string& unit,
                       const std::string& description, Range range, int count, Member member) {
    return declare<std::vector<double>>(
        {Option::Kind::kNumbers, key, unit, description, range, count},
        std::invoke(member, defaults_), member);
  }

  /// Path of a file, relative to the configuration that names it.
  template <class Member>
  OptionTable& file(const std::string& key, const std::string& description, Member member) {
    return declare<std::string>({Option::Kind::kFile, key, "", description},
                                std::invoke(member, defaults_), member);
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
      entries_.push_back({entry.option, [member, assign = entry.assign](Options& options,
                                                                        const OptionValue& value) {
                            assign(std::invoke(member, options), value);
                          }});
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
  struct Same {
    template <class Value>
    const Value& operator()(const Value& value) const {
      return value;
    }
  };

  /// Appends an option that sets `member` to `convert(value)`; `otherwise`: value of an absent key.
  template <class Value, class Member, class Convert = Same>
  OptionTable& declare(Option option, Value otherwise, Member member, Convert convert = {}) {
    option.otherwise = std::move(otherwise);
    entries_.push_back({std::move(option), [member, convert = std::move(convert)](
                                               Options& options, const OptionValue& value) {
                          std::invoke(member, options) = convert(std::get<Value>(value));
                        }});
    return *this;
  }

  Options defaults_;
  std::vector<Entry> entries_;
};

}  // namespace palpate::config
