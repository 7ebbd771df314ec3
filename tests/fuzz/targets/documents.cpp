// YAML texts as configurations: the text, then, separated by '\1', an override and a change as they
// arrive with a command that replaces a component.

#include "rt/config/node.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {
namespace {

std::string take_part(std::string& text) {
  const std::size_t cut = text.find('\1');
  const std::string part = text.substr(0, cut);
  text = cut == std::string::npos ? "" : text.substr(cut + 1);
  return part;
}

/// Reads every key with every kind of getter, each of which may only throw config::Error.
void ask(const config::Node& node, int depth) {
  const auto get = [](auto getter) {
    try {
      getter();
    } catch (const config::Error& error) {
      require(*error.what() != '\0', "an error says something");
    }
  };
  for (const std::string& key : node.keys()) {
    get([&] { node.number(key, {-1, 1}); });
    get([&] { node.integer(key, {-1e12, 1e12}); });
    get([&] { node.flag(key, true); });
    get([&] { node.text(key); });
    get([&] { node.texts(key); });
    get([&] { node.choice(key, {"a", "b"}); });
    get([&] { node.numbers(key, -1); });
    get([&] { node.vector3(key); });
    get([&] { node.points(key); });
    get([&] { node.pose(key); });
    get([&] { node.path(key); });
    get([&] { node.dump(key); });
    if (depth == 0) continue;
    get([&] { ask(node.child(key), depth - 1); });
    get([&] {
      for (const config::Node& item : node.list(key)) ask(item, depth - 1);
    });
  }
}

}  // namespace

std::vector<std::string> seeds() {
  return {
      "a: 1\nb: {c: [1, 2, 3], d: yes}\nlist: [{x: 1}, {x: 2}]\n\1list.1\1{x: 7, y: text}",
      "# remark\nframes:\n  object: {position: [1, 0, 0], rpy_deg: [0, 0, 90]}\n"
      "points: [[0, 0, 1], [1, .5, -2e-3]]\n\1frames.object\1{quaternion: [1, 0, 0, 0]}",
      "a: &a [1, 2]\nb: *a\nc: &c {d: *a}\ne: [*c, *c]\n\1\1f: ~",
      "sensing:\n  - name: wrist\n    component: ft_tare_only\n\1sensing.0\1{component: manual}",
      "text: \"a\\tb\\u00e9\"\nfolded: >\n  one\n  two\nliteral: |\n  one\n"};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  std::string rest(reinterpret_cast<const char*>(data), size);
  const std::string text = fuzz::take_part(rest), path = fuzz::take_part(rest);
  try {
    const config::Node node = config::Node::from_text(text, "f");
    node.hash();
    fuzz::ask(node, 3);
    node.check_all_used();
  } catch (const config::Error& error) {
    fuzz::require(*error.what() != '\0', "an error says something");
  }
  for (const bool replace : {false, true}) {
    try {
      const config::Node node = config::Node::from_text(text, "f");
      const config::Node changed = node.changed(path, rest, replace, "change");
      changed.hash();
      fuzz::ask(changed, 2);
    } catch (const config::Error&) {
    }
  }
  return 0;
}
