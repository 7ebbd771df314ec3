#pragma once

#include <string>

#include "rt/config/node.hpp"

namespace palpate::config {

/// Error text of `action`; empty if there is none.
template <typename Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace palpate::config
