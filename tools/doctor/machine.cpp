#include "tools/doctor/machine.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

namespace palpate::doctor {

namespace fs = std::filesystem;

std::optional<std::string> Machine::read(const std::string& path) const {
  std::error_code error;
  if (fs::is_directory(root_ / path, error)) return std::nullopt;
  std::ifstream file(root_ / path);
  if (!file) return std::nullopt;
  std::stringstream text;
  text << file.rdbuf();
  std::string whole = text.str();
  while (!whole.empty() && std::isspace(static_cast<unsigned char>(whole.back())) != 0)
    whole.pop_back();
  return whole;
}

std::vector<std::string> Machine::lines(const std::string& path) const {
  std::vector<std::string> lines;
  std::istringstream text(read(path).value_or(""));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::optional<std::int64_t> Machine::number(const std::string& path) const {
  const std::optional<std::string> text = read(path);
  std::int64_t value = 0;
  if (!text) return std::nullopt;
  const auto result = std::from_chars(text->data(), text->data() + text->size(), value);
  if (result.ec != std::errc()) return std::nullopt;
  return value;
}

std::vector<std::string> Machine::list(const std::string& path) const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(root_ / path, error), end; !error && at != end;
       at.increment(error))
    names.push_back(at->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

bool Machine::exists(const std::string& path) const { return resolve(path).has_value(); }

std::string Machine::link(const std::string& path) const {
  std::error_code error;
  const fs::path target = fs::read_symlink(root_ / path, error);
  return error ? "" : target.string();
}

std::optional<std::string> Machine::resolve(const std::string& path) const {
  constexpr int kMostLinks = 40;
  std::string at = path;
  for (int i = 0; i < kMostLinks; ++i) {
    const std::string target = link(at);
    if (target.empty()) {
      std::error_code error;
      if (!fs::exists(fs::symlink_status(root_ / at, error))) return std::nullopt;
      return at;
    }
    at = target.front() == '/' ? target.substr(1)
                               : (fs::path(at).parent_path() / target).lexically_normal().string();
  }
  return std::nullopt;
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream text(line);
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

std::vector<int> cpu_list(const std::string& text) {
  std::vector<int> list;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at < end) {
    int first = 0, last = 0;
    auto result = std::from_chars(at, end, first);
    if (result.ec != std::errc()) break;
    at = result.ptr;
    last = first;
    if (at < end && *at == '-') {
      result = std::from_chars(at + 1, end, last);
      if (result.ec != std::errc()) break;
      at = result.ptr;
    }
    constexpr int kMost = 4096;
    for (int cpu = first; cpu <= std::min(last, kMost); ++cpu) list.push_back(cpu);
    if (at < end && *at == ',') ++at;
  }
  return list;
}

}  // namespace palpate::doctor
