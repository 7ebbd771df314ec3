#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rt/bus/authentication.hpp"

namespace palpate::view {

/// Which names a browser may know the server by, and whose pages may talk to it. A page of another
/// site can make a browser connect to this machine; what tells it apart are the headers Host and
/// Origin, which pages cannot forge.
class Doorman {
 public:
  /// `names`: hosts without a port, e.g. "127.0.0.1", "localhost", "[::1]".
  Doorman(std::vector<std::string> names, int port);

  /// Whether the header Host names this server, which the name of a site that now points here (DNS
  /// rebinding) does not.
  bool knows_host(std::string_view host) const;
  /// Whether the header Origin is that of our own page as `host` serves it. Without the header:
  /// false.
  bool knows_origin(std::string_view origin, std::string_view host) const;

 private:
  std::vector<std::string> names_;
  int port_;
};

/// What entitles a page to give commands: 32 random bytes, shown as 64 hexadecimal digits.
class Token {
 public:
  Token();  // a new one, at random
  /// From a file as palpate-command --make-key writes; throws std::runtime_error.
  explicit Token(const std::string& key_file) : bytes_(bus::read_key_file(key_file)) {}

  std::string text() const;
  /// In a time that tells nothing of where they differ.
  bool is(std::string_view text) const;

 private:
  bus::Key bytes_;
};

}  // namespace palpate::view
