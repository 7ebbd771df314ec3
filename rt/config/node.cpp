#include "rt/config/node.hpp"

#include "rt/config/node_impl.hpp"

namespace palpate::config {
namespace {

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

Node Node::child(const Key& key) const {
  impl_->declare(key, "section").required = true;
  const Impl::Entry entry = impl_->require(key.name, "a mapping");
  if (!entry.value.IsMap()) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not a mapping of keys");
  }
  return child_or_empty(key);
}

Node Node::child_or_empty(const Key& key) const {
  impl_->declare(key, "section");
  const Impl::Entry entry = impl_->find(key.name);
  if (entry.present && !entry.value.IsMap() && !entry.value.IsNull()) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not a mapping of keys");
  }
  return Node(std::make_shared<Impl>(
      Impl{impl_->document, entry.value, join(impl_->path, key.name), entry.line}));
}

std::vector<Node> Node::list(const Key& key) const {
  impl_->declare(key, "list of sections");
  const Impl::Entry entry = impl_->find(key.name);
  std::vector<Node> items;
  if (!entry.present || entry.value.IsNull()) return items;
  if (!entry.value.IsSequence()) {
    impl_->fail(key.name, entry.line, shown(entry.value) + " is not a list of mappings");
  }
  for (const auto& item : entry.value) {
    const std::string item_key = join(key.name, std::to_string(items.size()));
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

const std::vector<std::string>& Node::warnings() const { return impl_->document->warnings(); }

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
