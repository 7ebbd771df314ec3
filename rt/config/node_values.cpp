#include <filesystem>

#include "rt/config/node_impl.hpp"

namespace palpate::config {
namespace {

Choices undescribed(const std::vector<std::string>& names) {
  Choices choices;
  for (const std::string& name : names) choices.emplace_back(name, "");
  return choices;
}

std::string type_name(const Option& option) {
  switch (option.kind) {
    case Option::Kind::kNumber:
      return "number";
    case Option::Kind::kInteger:
      return "whole number";
    case Option::Kind::kFlag:
      return "flag";
    case Option::Kind::kChoice:
      return "one of";
    case Option::Kind::kFile:
      return "file";
    case Option::Kind::kNumbers:
      break;
  }
  return (option.count < 0 ? "" : std::to_string(option.count) + " ") + "numbers";
}

}  // namespace

double Node::number(const Key& key, Range range) const {
  impl_->declare(key, "number", range).required = true;
  const Impl::Entry entry = impl_->require(key.name, range_text(range));
  return impl_->to_number(entry.value, key.name, entry.line, range);
}

double Node::number(const Key& key, Range range, double otherwise) const {
  impl_->declare(key, "number", range).fallback = number_text(otherwise);
  const Impl::Entry entry = impl_->find(key.name);
  return entry.present ? impl_->to_number(entry.value, key.name, entry.line, range) : otherwise;
}

int Node::integer(const Key& key, Range range) const {
  impl_->declare(key, "whole number", range).required = true;
  range.lower = std::max(range.lower, double{std::numeric_limits<int>::min()});
  range.upper = std::min(range.upper, double{std::numeric_limits<int>::max()});
  const Impl::Entry entry = impl_->require(key.name, range_text(range));
  long number = 0;
  if (!is_plain(entry.value) || !math::parse_number(entry.value.Scalar(), number)) {
    impl_->fail(key.name, entry.line,
                shown(entry.value) + " is not a whole number" + allowed(range));
  }
  return static_cast<int>(impl_->to_number(entry.value, key.name, entry.line, range));
}

int Node::integer(const Key& key, Range range, int otherwise) const {
  impl_->declare(key, "whole number", range).fallback = std::to_string(otherwise);
  return impl_->find(key.name).present ? integer(key, range) : otherwise;
}

void Node::declare_quantity(const Key& key, Range range, bool is_required,
                            const std::string& otherwise) const {
  Declaration& declared = impl_->declare(key, "number with unit", range);
  declared.fallback = otherwise;
  declared.required = is_required;
}

bool Node::flag(const Key& key, bool otherwise) const {
  impl_->declare(key, "flag").fallback = otherwise ? "true" : "false";
  const Impl::Entry entry = impl_->find(key.name);
  if (!entry.present) return otherwise;
  const bool yes = is_plain(entry.value) && entry.value.Scalar() == "true";
  if (!yes && !(is_plain(entry.value) && entry.value.Scalar() == "false")) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is no flag; allowed: true, false");
  }
  return yes;
}

std::string Node::text(const Key& key) const {
  impl_->declare(key, "text").required = true;
  const Impl::Entry entry = impl_->require(key.name, "text");
  if (!entry.value.IsScalar()) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not text");
  }
  return entry.value.Scalar();
}

std::string Node::text(const Key& key, const std::string& otherwise) const {
  impl_->declare(key, "text").fallback = otherwise.empty() ? "\"\"" : otherwise;
  return impl_->find(key.name).present ? text(key) : otherwise;
}

std::string Node::choice(const Key& key, const std::vector<std::string>& names) const {
  Declaration& declared = impl_->declare(key, "one of");
  declared.allowed = listed(names);
  declared.choices = undescribed(names);
  declared.required = declared.fallback.empty();
  const Impl::Entry entry = impl_->require(key.name, listed(names));
  const bool known = entry.value.IsScalar() &&
                     std::find(names.begin(), names.end(), entry.value.Scalar()) != names.end();
  if (!known) {
    impl_->fail(key.name, entry.line,
                shown(entry.value) + " is unknown; allowed: " + listed(names));
  }
  return entry.value.Scalar();
}

std::string Node::choice(const Key& key, const std::vector<std::string>& names,
                         const std::string& otherwise) const {
  Declaration& declared = impl_->declare(key, "one of");
  declared.allowed = listed(names);
  declared.choices = undescribed(names);
  declared.fallback = otherwise;
  if (!declared.present) declared.value = otherwise;
  return impl_->find(key.name).present ? choice(key, names) : otherwise;
}

std::vector<std::string> Node::texts(const Key& key) const {
  impl_->declare(key, "list of texts").required = true;
  const Impl::Entry entry = impl_->require(key.name, "a list of texts");
  if (!entry.value.IsSequence())
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not a list of texts");
  std::vector<std::string> texts;
  for (const auto& item : entry.value) {
    if (!item.IsScalar() || item.Scalar().empty())
      impl_->fail(join(key.name, std::to_string(texts.size())), item.Mark().line,
                  shown(item) + " is not a text");
    texts.push_back(item.Scalar());
  }
  return texts;
}

std::string Node::component(const Key& key, const Choices& known) const {
  std::vector<std::string> names;
  for (const auto& [name, description] : known) names.push_back(name);
  Declaration& declared = impl_->declare(key, "one of");
  declared.allowed = listed(names);
  declared.required = true;
  declared.choices = known;
  return choice(key, names);
}

std::string Node::given_name(const Option& option) const {
  for (const std::string& former : option.aliases) {
    if (!has(former)) continue;
    if (has(option.key))
      fail(former, "is the former name of '" + option.key + "', which is given as well");
    return former;
  }
  return option.key;
}

bool Node::has_value(const Option& option) const {
  if (!option.optional) return true;
  const Key key(option.key, option.unit.c_str(), option.description.c_str());
  Declaration& declared = impl_->declare(key, type_name(option), option.range);
  declared.allowed = option.choices.empty() ? declared.allowed : listed(option.choices);
  declared.choices = undescribed(option.choices);
  impl_->find(option.key);
  return has(given_name(option));
}

OptionValue Node::value(const Option& option) const {
  Key key(given_name(option), option.unit.c_str(), option.description.c_str());
  if (key.name != option.key) {
    key.kind = option.key.c_str();
    impl_->find(option.key);
    impl_->warn(key.name, "is the former name of '" + option.key + "': rename it");
  }
  const bool given = option.required || (option.optional && has(key.name));
  switch (option.kind) {
    case Option::Kind::kNumber:
      return given ? number(key, option.range)
                   : number(key, option.range, std::get<double>(option.otherwise));
    case Option::Kind::kInteger:
      return given ? integer(key, option.range)
                   : integer(key, option.range, std::get<int>(option.otherwise));
    case Option::Kind::kFlag:
      if (given && !has(key.name)) fail(option.key, "is missing; allowed: true, false");
      return flag(key, std::get<bool>(option.otherwise));
    case Option::Kind::kChoice:
      return given ? choice(key, option.choices)
                   : choice(key, option.choices, std::get<std::string>(option.otherwise));
    case Option::Kind::kFile:
      return given || has(key.name) ? path(key) : std::get<std::string>(option.otherwise);
    case Option::Kind::kNumbers:
      break;
  }
  return given ? numbers(key, option.count, option.range)
               : numbers(key, option.count, option.range,
                         std::get<std::vector<double>>(option.otherwise));
}

std::vector<double> Node::numbers(const Key& key, int count, Range range) const {
  Declaration& declared =
      impl_->declare(key, (count < 0 ? "" : std::to_string(count) + " ") + "numbers", range);
  declared.required = declared.fallback.empty();
  const Impl::Entry entry = impl_->require(key.name, "a list of numbers");
  return impl_->to_numbers(entry.value, key.name, entry.line, count, range);
}

std::vector<double> Node::numbers(const Key& key, int count, Range range,
                                  const std::vector<double>& otherwise) const {
  std::string shown;
  for (const double number : otherwise) shown += (shown.empty() ? "" : ", ") + number_text(number);
  impl_->declare(key, (count < 0 ? "" : std::to_string(count) + " ") + "numbers", range).fallback =
      "[" + shown + "]";
  return impl_->find(key.name).present ? numbers(key, count, range) : otherwise;
}

Eigen::Vector3d Node::vector3(const Key& key, Range range) const {
  return Eigen::Vector3d(numbers(key, 3, range).data());
}

Eigen::Vector3d Node::vector3(const Key& key, Range range, const Eigen::Vector3d& otherwise) const {
  return Eigen::Vector3d(
      numbers(key, 3, range, {otherwise.x(), otherwise.y(), otherwise.z()}).data());
}

std::vector<Eigen::Vector3d> Node::points(const Key& key) const {
  impl_->declare(key, "points").required = true;
  const Impl::Entry entry = impl_->require(key.name, "a list of points [x, y, z]");
  if (!entry.value.IsSequence()) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not a list of points [x, y, z]");
  }
  std::vector<Eigen::Vector3d> points;
  for (const auto& item : entry.value) {
    const std::string item_key = join(key.name, std::to_string(points.size()));
    points.emplace_back(impl_->to_numbers(item, item_key, item.Mark().line, 3, {}).data());
  }
  return points;
}

math::Pose Node::pose(const Key& key) const {
  impl_->declare(key, "pose").fallback = "identity";
  const Undeclared parts;
  const Node node = child_or_empty(key);
  const Eigen::Vector3d position = node.vector3("position", {}, Eigen::Vector3d::Zero());
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (node.has("quaternion")) {
    const std::vector<double> wxyz = node.numbers("quaternion", 4);
    if (!math::is_unit_quaternion(wxyz.data())) {
      node.fail("quaternion", "norm is not 1; allowed: a unit quaternion [w, x, y, z]");
    }
    if (node.has("rpy_deg"))
      node.fail("rpy_deg", "is given as well as quaternion; allowed: one of them");
    rotation = math::rotation_from_wxyz(wxyz.data());
  } else {
    const Eigen::Vector3d rpy =
        node.vector3("rpy_deg", {-360, 360}, Eigen::Vector3d::Zero()) * M_PI / 180;
    rotation = math::exp_rotation(rpy.z() * Eigen::Vector3d::UnitZ()) *
               math::exp_rotation(rpy.y() * Eigen::Vector3d::UnitY()) *
               math::exp_rotation(rpy.x() * Eigen::Vector3d::UnitX());
    impl_->document->mark_used(node.impl_->path, "quaternion");
  }
  return math::make_pose(rotation, position);
}

std::string Node::path(const Key& key) const {
  impl_->declare(key, "file").required = true;
  const std::filesystem::path path = text(key);
  return (std::filesystem::path(impl_->document->folder(join(impl_->path, key.name))) / path)
      .lexically_normal()
      .string();
}

}  // namespace palpate::config
