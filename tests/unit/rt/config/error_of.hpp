#pragma once

#include <string>

#include "rt/config/node.hpp"

namespace palpate::config {

/// What the error of `action` says; empty where there is none.
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
