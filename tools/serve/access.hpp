#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rt/bus/authentication.hpp"

namespace palpate::serve {

/// The host names by which a browser may address the server, and the origins whose pages may talk
/// to it. A page of another site can make a browser connect to this machine; it is distinguished by
/// the headers Host and Origin, which pages cannot forge.
class Doorman {
 public:
  /// `names`: hosts without a port, e.g. "127.0.0.1", "localhost", "[::1]".
  Doorman(std::vector<std::string> names, int port);

  /// Whether the header Host names this server; false for the name of another site that resolves to
  /// this machine (DNS rebinding).
  bool knows_host(std::string_view host) const;
  /// Whether the header Origin is that of our own page as served under `host`. Without the header:
  /// false.
  bool knows_origin(std::string_view origin, std::string_view host) const;

 private:
  std::vector<std::string> names_;
  int port_;
};

/// Token that authorises a page to give commands: 32 random bytes, shown as 64 hexadecimal digits.
class Token {
 public:
  Token();  // a new random token
  /// From a file written by palpate-command --make-key; throws std::runtime_error.
  explicit Token(const std::string& key_file) : bytes_(bus::read_key_file(key_file)) {}

  std::string text() const;
  /// Comparison in constant time.
  bool is(std::string_view text) const;

 private:
  bus::Key bytes_;
};

}  // namespace palpate::serve
