#include "tools/common/program.hpp"

#include <cstdio>

#include "rt/config/node.hpp"
#include "tools/common/interruption.hpp"

namespace palpate::common {

int run_program(const std::string& prefix, const std::function<int()>& body, int failed) {
  const auto report = [&prefix](const std::exception& error, int code) {
    std::fprintf(stderr, "%s: %s\n", prefix.c_str(), error.what());
    return code;
  };
  try {
    return body();
  } catch (const Interrupted& interrupted) {
    return report(interrupted, config::kExitInterrupted);
  } catch (const config::Error& error) {
    return report(error, config::kExitCode);
  } catch (const std::exception& error) {
    return report(error, failed);
  }
}

}  // namespace palpate::common
