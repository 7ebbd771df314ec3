#include "rt/config/node.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "rt/config/document.hpp"

namespace palpate::config {
namespace {

std::string range_text(Range range) {
  std::ostringstream text;
  text.precision(10);
  if (std::isinf(range.lower) && std::isinf(range.upper)) {
    text << "any finite number";
  } else if (std::isinf(range.upper)) {
    text << "at least " << range.lower;
  } else if (std::isinf(range.lower)) {
    text << "at most " << range.upper;
  } else {
    text << range.lower << " to " << range.upper;
  }
  return text.str();
}

std::string allowed(Range range) { return "; allowed: " + range_text(range); }

template <typename List>
std::string listed(const List& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text.empty() ? "nothing" : text;
}

/// The text of a plain, unquoted scalar (a quoted number is text).
bool is_plain(const YAML::Node& node) { return node.IsScalar() && node.Tag() != "!"; }

/// True where the whole of `text` is a number of this type, written without regard to locale.
template <typename Number>
bool parse(const std::string& text, Number& number) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [rest, error] = std::from_chars(begin, end, number);
  return error == std::errc() && rest == end && begin != end;
}

std::string shown(const YAML::Node& node) {
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  if (node.IsSequence()) return "a list";
  return node.IsMap() ? "a mapping" : "nothing";
}

/// YAML in one style, whatever the style of the source.
std::string flow_text(const YAML::Node& node) {
  YAML::Emitter text;
  const auto emit = [&text](const auto& self, const YAML::Node& part) -> void {
    if (part.IsMap()) {
      text << YAML::Flow << YAML::BeginMap;
      for (const auto& entry : part) {
        text << YAML::Key << entry.first.Scalar() << YAML::Value;
        self(self, entry.second);
      }
      text << YAML::EndMap;
    } else if (part.IsSequence()) {
      text << YAML::Flow << YAML::BeginSeq;
      for (const auto& item : part) self(self, item);
      text << YAML::EndSeq;
    } else {
      text << part;
    }
  };
  emit(emit, node);
  return text.c_str();
}

}  // namespace

struct Node::Impl {
  std::shared_ptr<Document> document;
  YAML::Node node;   // a mapping; null where the key is absent
  std::string path;  // full key
  int line = -1;     // 0-based

  struct Entry {
    bool present = false;
    YAML::Node value;
    int line = -1;
  };

  /// The entry without marking it as used.
  Entry peek(const std::string& key) const {
    if (node.IsMap()) {
      for (const auto& entry : node) {
        if (entry.first.Scalar() == key) return {true, entry.second, entry.first.Mark().line};
      }
    }
    return {false, YAML::Node(), line};
  }

  Entry find(const std::string& key) const {
    document->mark_used(path, key);
    return peek(key);
  }

  Entry require(const std::string& key, const std::string& kind) const {
    Entry entry = find(key);
    if (!entry.present) fail(key, entry.line, "is missing; allowed: " + kind);
    return entry;
  }

  [[noreturn]] void fail(const std::string& key, int at, const std::string& what) const {
    const std::string full = join(path, key);
    throw Error(document->location(full, at) + ": " + (full.empty() ? "" : full + ": ") + what);
  }

  double to_number(const YAML::Node& value, const std::string& key, int at, Range range) const {
    double number = 0;
    if (!is_plain(value) || !parse(value.Scalar(), number) || !std::isfinite(number)) {
      fail(key, at, shown(value) + " is not a finite number" + allowed(range));
    }
    if (!(number >= range.lower && number <= range.upper)) {
      fail(key, at, shown(value) + " is out of range" + allowed(range));
    }
    return number;
  }

  std::vector<double> to_numbers(const YAML::Node& value, const std::string& key, int at, int count,
                                 Range range) const {
    const bool any = count < 0;
    if (!value.IsSequence() || (!any && static_cast<int>(value.size()) != count)) {
      fail(key, at,
           "must be a list of " + (any ? "" : std::to_string(count) + " ") + "numbers" +
               allowed(range));
    }
    std::vector<double> numbers;
    for (const auto& item : value) {
      const std::string item_key = join(key, std::to_string(numbers.size()));
      numbers.push_back(to_number(item, item_key, item.Mark().line, range));
    }
    return numbers;
  }
};

Node::Node(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

Node Node::load_file(const std::string& path, const std::vector<std::string>& overrides) {
  const std::shared_ptr<Document> document = Document::load(path);
  for (const std::string& item : overrides) document->apply_override(item);
  return Node(std::make_shared<Impl>(Impl{document, document->root(), "", 0}));
}

Node Node::from_text(const std::string& text, const std::string& name) {
  const auto document = std::make_shared<Document>(text, name, "");
  return Node(std::make_shared<Impl>(Impl{document, document->root(), "", 0}));
}

bool Node::has(const std::string& key) const { return impl_->peek(key).present; }

bool Node::is_mapping(const std::string& key) const {
  const Impl::Entry entry = impl_->peek(key);
  return entry.present && entry.value.IsMap();
}

Node Node::child(const std::string& key) const {
  const Impl::Entry entry = impl_->require(key, "a mapping");
  if (!entry.value.IsMap()) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not a mapping of keys");
  }
  return child_or_empty(key);
}

Node Node::child_or_empty(const std::string& key) const {
  const Impl::Entry entry = impl_->find(key);
  if (entry.present && !entry.value.IsMap() && !entry.value.IsNull()) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not a mapping of keys");
  }
  return Node(std::make_shared<Impl>(
      Impl{impl_->document, entry.value, join(impl_->path, key), entry.line}));
}

std::vector<Node> Node::list(const std::string& key) const {
  const Impl::Entry entry = impl_->find(key);
  std::vector<Node> items;
  if (!entry.present || entry.value.IsNull()) return items;
  if (!entry.value.IsSequence()) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not a list of mappings");
  }
  for (const auto& item : entry.value) {
    const std::string item_key = join(key, std::to_string(items.size()));
    const int line = item.Mark().line;
    if (!item.IsMap()) impl_->fail(item_key, line, shown(item) + " is not a mapping of keys");
    items.push_back(Node(
        std::make_shared<Impl>(Impl{impl_->document, item, join(impl_->path, item_key), line})));
  }
  return items;
}

std::vector<std::string> Node::keys() const {
  std::vector<std::string> keys;
  if (!impl_->node.IsMap()) return keys;
  for (const auto& entry : impl_->node) keys.push_back(entry.first.Scalar());
  return keys;
}

double Node::number(const std::string& key, Range range) const {
  const Impl::Entry entry = impl_->require(key, range_text(range));
  return impl_->to_number(entry.value, key, entry.line, range);
}

double Node::number(const std::string& key, Range range, double otherwise) const {
  const Impl::Entry entry = impl_->find(key);
  return entry.present ? impl_->to_number(entry.value, key, entry.line, range) : otherwise;
}

int Node::integer(const std::string& key, Range range) const {
  range.lower = std::max(range.lower, double{std::numeric_limits<int>::min()});
  range.upper = std::min(range.upper, double{std::numeric_limits<int>::max()});
  const Impl::Entry entry = impl_->require(key, range_text(range));
  long number = 0;
  if (!is_plain(entry.value) || !parse(entry.value.Scalar(), number)) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not a whole number" + allowed(range));
  }
  return static_cast<int>(impl_->to_number(entry.value, key, entry.line, range));
}

int Node::integer(const std::string& key, Range range, int otherwise) const {
  return impl_->find(key).present ? integer(key, range) : otherwise;
}

bool Node::flag(const std::string& key, bool otherwise) const {
  const Impl::Entry entry = impl_->find(key);
  if (!entry.present) return otherwise;
  const bool yes = is_plain(entry.value) && entry.value.Scalar() == "true";
  if (!yes && !(is_plain(entry.value) && entry.value.Scalar() == "false")) {
    impl_->fail(key, entry.line, shown(entry.value) + " is no flag; allowed: true, false");
  }
  return yes;
}

std::string Node::text(const std::string& key) const {
  const Impl::Entry entry = impl_->require(key, "text");
  if (!entry.value.IsScalar()) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not text");
  }
  return entry.value.Scalar();
}

std::string Node::text(const std::string& key, const std::string& otherwise) const {
  return impl_->find(key).present ? text(key) : otherwise;
}

std::string Node::choice(const std::string& key, const std::vector<std::string>& names) const {
  const Impl::Entry entry = impl_->require(key, listed(names));
  const bool known = entry.value.IsScalar() &&
                     std::find(names.begin(), names.end(), entry.value.Scalar()) != names.end();
  if (!known) {
    impl_->fail(key, entry.line, shown(entry.value) + " is unknown; allowed: " + listed(names));
  }
  return entry.value.Scalar();
}

std::string Node::choice(const std::string& key, const std::vector<std::string>& names,
                         const std::string& otherwise) const {
  return impl_->find(key).present ? choice(key, names) : otherwise;
}

std::vector<std::string> Node::texts(const std::string& key) const {
  const Impl::Entry entry = impl_->require(key, "a list of texts");
  if (!entry.value.IsSequence())
    impl_->fail(key, entry.line, shown(entry.value) + " is not a list of texts");
  std::vector<std::string> texts;
  for (const auto& item : entry.value) {
    if (!item.IsScalar() || item.Scalar().empty())
      impl_->fail(join(key, std::to_string(texts.size())), item.Mark().line,
                  shown(item) + " is not a text");
    texts.push_back(item.Scalar());
  }
  return texts;
}

std::vector<double> Node::numbers(const std::string& key, int count, Range range) const {
  const Impl::Entry entry = impl_->require(key, "a list of numbers");
  return impl_->to_numbers(entry.value, key, entry.line, count, range);
}

Eigen::Vector3d Node::vector3(const std::string& key, Range range) const {
  return Eigen::Vector3d(numbers(key, 3, range).data());
}

Eigen::Vector3d Node::vector3(const std::string& key, Range range,
                              const Eigen::Vector3d& otherwise) const {
  return impl_->find(key).present ? vector3(key, range) : otherwise;
}

std::vector<Eigen::Vector3d> Node::points(const std::string& key) const {
  const Impl::Entry entry = impl_->require(key, "a list of points [x, y, z]");
  if (!entry.value.IsSequence()) {
    impl_->fail(key, entry.line, shown(entry.value) + " is not a list of points [x, y, z]");
  }
  std::vector<Eigen::Vector3d> points;
  for (const auto& item : entry.value) {
    const std::string item_key = join(key, std::to_string(points.size()));
    points.emplace_back(impl_->to_numbers(item, item_key, item.Mark().line, 3, {}).data());
  }
  return points;
}

math::Pose Node::pose(const std::string& key) const {
  const Node node = child_or_empty(key);
  const Eigen::Vector3d position = node.vector3("position", {}, Eigen::Vector3d::Zero());
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (node.has("quaternion")) {
    const std::vector<double> wxyz = node.numbers("quaternion", 4);
    if (!math::is_unit_quaternion(wxyz.data())) {
      node.fail("quaternion", "norm is not 1; allowed: a unit quaternion [w, x, y, z]");
    }
    if (node.has("rpy_deg")) node.fail("rpy_deg", "given beside quaternion; allowed: one of them");
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

std::string Node::path(const std::string& key) const {
  const std::filesystem::path path = text(key);
  return (std::filesystem::path(impl_->document->folder(join(impl_->path, key))) / path)
      .lexically_normal()
      .string();
}

void Node::check_all_used() const {
  const auto check = [&](const auto& self, const YAML::Node& node,
                         const std::string& path) -> void {
    const std::set<std::string>& used = impl_->document->used(path);
    for (const auto& entry : node) {
      const std::string key = join(path, entry.first.Scalar());
      if (used.count(entry.first.Scalar()) == 0) {
        throw Error(impl_->document->location(key, entry.first.Mark().line) + ": " + key +
                    ": unknown key; allowed: " + listed(used));
      }
      if (entry.second.IsMap()) self(self, entry.second, key);
      if (!entry.second.IsSequence()) continue;
      int index = 0;
      for (const auto& item : entry.second) {
        if (item.IsMap()) self(self, item, join(key, std::to_string(index)));
        ++index;
      }
    }
  };
  if (impl_->node.IsMap()) check(check, impl_->node, impl_->path);
}

void Node::leave_to_another(const std::string& key) const {
  const auto mark = [&](const auto& self, const YAML::Node& node, const std::string& path) -> void {
    if (node.IsMap()) {
      for (const auto& entry : node) {
        impl_->document->mark_used(path, entry.first.Scalar());
        self(self, entry.second, join(path, entry.first.Scalar()));
      }
    } else if (node.IsSequence()) {
      for (std::size_t i = 0; i < node.size(); ++i)
        self(self, node[i], join(path, std::to_string(i)));
    }
  };
  const Impl::Entry entry = impl_->find(key);
  if (entry.present) mark(mark, entry.value, join(impl_->path, key));
}

void Node::fail(const std::string& key, const std::string& what) const {
  impl_->fail(key, key.empty() ? impl_->line : impl_->peek(key).line, what);
}

Node Node::changed(const std::string& path, const std::string& text, bool replace,
                   const std::string& name) const {
  const std::shared_ptr<Document> document = impl_->document->changed(path, text, replace, name);
  return Node(std::make_shared<Impl>(Impl{document, document->root(), "", 0}));
}

std::string Node::dump(const std::string& key) const {
  const Impl::Entry entry = impl_->peek(key);
  return entry.present ? flow_text(entry.value) : "";
}

std::string Node::dump() const { return flow_text(impl_->node); }

std::int64_t Node::hash() const { return impl_->document->hash(); }

}  // namespace palpate::config
