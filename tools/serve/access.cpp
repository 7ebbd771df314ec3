#include "tools/serve/access.hpp"

#include <sodium.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace palpate::serve {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return out;
}

}  // namespace

Doorman::Doorman(std::vector<std::string> names, int port) : names_(std::move(names)), port_(port) {
  for (std::string& name : names_) name = lower(name);
}

bool Doorman::knows_host(std::string_view host) const {
  const std::string given = lower(host);
  const std::string suffix = ":" + std::to_string(port_);
  return std::any_of(names_.begin(), names_.end(), [&](const std::string& name) {
    return given == name + suffix || (port_ == 80 && given == name);
  });
}

bool Doorman::knows_origin(std::string_view origin, std::string_view host) const {
  // Behind a proxy that adds TLS, the page's scheme is https.
  const std::string given = lower(origin), ours = lower(host);
  return knows_host(host) && (given == "http://" + ours || given == "https://" + ours);
}

Token::Token() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium finds no source of random numbers");
  randombytes_buf(bytes_.data(), bytes_.size());
}

std::string Token::text() const {
  char digits[2 * bus::kKeySize + 1];
  sodium_bin2hex(digits, sizeof(digits), bytes_.data(), bytes_.size());
  return digits;
}

bool Token::is(std::string_view text) const {
  const std::string right = this->text();
  return text.size() == right.size() && sodium_memcmp(text.data(), right.data(), right.size()) == 0;
}

}  // namespace palpate::serve
