#pragma once

#include <map>
#include <string>
#include <vector>

namespace palpate::types {

/// The words of an .lcm file, without its comments, which are kept by line.
class Tokens {
 public:
  /// Throws std::runtime_error for a comment that does not end.
  Tokens(const std::string& text, std::string file);

  bool at_end() const { return next_ == tokens_.size(); }
  /// The next word; empty at the end.
  const std::string& peek() const;
  std::string take();
  /// Takes the next word if it is this one.
  bool accept(const std::string& word);
  /// Throws std::runtime_error unless the next word is this one.
  void expect(const std::string& word);

  /// FILE:LINE of the next word.
  std::string place() const;
  /// Of the line of the next word, or else that of the lines directly before.
  std::string comment() const;
  /// Throws std::runtime_error "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Token {
    std::string text;
    int line;
  };
  int line() const;

  std::string file_;
  std::vector<Token> tokens_;
  std::map<int, std::string> comments_;  // by the line of their end
  std::map<int, int> words_;             // by line: how many
  std::size_t next_ = 0;
};

}  // namespace palpate::types
