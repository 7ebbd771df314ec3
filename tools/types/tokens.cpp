#include "tools/types/tokens.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace palpate::types {
namespace {

constexpr char kSingle[] = ";,[]{}=()";

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Without the marks that decorate comments, in one line.
std::string cleaned(const std::string& comment) {
  std::string result;
  bool at_begin = true, spaced = false;
  for (const char c : comment) {
    if (c == '\n') at_begin = true;
    if (is_space(c) || (at_begin && (c == '*' || c == '/' || c == '!'))) {
      spaced = true;
      continue;
    }
    at_begin = false;
    if (spaced && !result.empty()) result += ' ';
    spaced = false;
    result += c;
  }
  return result;
}

}  // namespace

Tokens::Tokens(const std::string& text, std::string file) : file_(std::move(file)) {
  int line = 1;
  const auto begins = [&text](std::size_t at, const char* what) {
    return text.compare(at, 2, what) == 0;
  };
  for (std::size_t at = 0; at < text.size();) {
    if (is_space(text[at])) {
      if (text[at] == '\n') ++line;
      ++at;
    } else if (begins(at, "//") || begins(at, "/*")) {
      const bool is_line = begins(at, "//");
      const std::size_t end = text.find(is_line ? "\n" : "*/", at + 2);
      if (end == std::string::npos && !is_line)
        throw std::runtime_error(file_ + ":" + std::to_string(line) + ": the comment does not end");
      const std::string comment =
          text.substr(at + 2, end == std::string::npos ? end : end - at - 2);
      line += static_cast<int>(std::count(comment.begin(), comment.end(), '\n'));
      std::string& kept = comments_[line];
      kept += (kept.empty() ? "" : " ") + cleaned(comment);
      at = end == std::string::npos ? text.size() : is_line ? end : end + 2;
    } else {
      std::size_t end = at + 1;
      const auto is_single = [](char c) {
        return c != '\0' && std::string(kSingle).find(c) != std::string::npos;
      };
      while (!is_single(text[at]) && end < text.size() && !is_space(text[end]) &&
             !is_single(text[end]) && !begins(end, "//") && !begins(end, "/*"))
        ++end;
      tokens_.push_back({text.substr(at, end - at), line});
      ++words_[line];
      at = end;
    }
  }
}

const std::string& Tokens::peek() const {
  static const std::string kNothing;
  return at_end() ? kNothing : tokens_[next_].text;
}

std::string Tokens::take() {
  if (at_end()) fail("the file ends too early");
  return tokens_[next_++].text;
}

bool Tokens::accept(const std::string& word) {
  if (at_end() || tokens_[next_].text != word) return false;
  ++next_;
  return true;
}

void Tokens::expect(const std::string& word) {
  if (accept(word)) return;
  fail("'" + word + "' is missing before " + (at_end() ? "the end" : "'" + peek() + "'"));
}

int Tokens::line() const {
  return tokens_.empty() ? 1 : tokens_[std::min(next_, tokens_.size() - 1)].line;
}

std::string Tokens::place() const { return file_ + ":" + std::to_string(line()); }

std::string Tokens::comment() const {
  const auto here = comments_.find(line());
  if (here != comments_.end()) return here->second;
  std::string result;
  for (int above = line() - 1; words_.count(above) == 0; --above) {
    const auto found = comments_.find(above);
    if (found == comments_.end()) break;
    result = found->second + (result.empty() ? "" : " ") + result;
  }
  return result;
}

void Tokens::fail(const std::string& what) const {
  throw std::runtime_error(place() + ": " + what);
}

}  // namespace palpate::types
