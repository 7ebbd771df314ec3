#include "tools/lab/faults/rows.hpp"

#include <algorithm>

#include "tools/lab/faults/rows_plugins.hpp"

namespace palpate::faults {

std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (const auto& some : {message_rows(), sensor_rows(), component_rows(), mechanics_rows(),
                           configuration_rows(), plugin_rows()})
    rows.insert(rows.end(), some.begin(), some.end());
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return std::stoi(a.number) < std::stoi(b.number);
  });
  return rows;
}

std::vector<Elsewhere> rows_elsewhere() {
  const char* const kProcess = "see process tests";
  return {{"8", "malformed packets", kProcess},
          {"9", "oversize packets, fragments", kProcess},
          {"11", "flood", kProcess},
          {"13", "crash of a component", kProcess},
          {"15", "corrupt model file", "see fuzz tests"},
          {"16", "invalid mesh", "see fuzz tests"},
          {"20", "kill -9 and restart", kProcess},
          {"22", "log disk full", kProcess},
          {"23", "starved processor, memory pressure", "by hand"},
          {"24", "SIGTERM, second start, port in use", kProcess},
          {"25", "long run", "palpate-evaluate soak, and soak --virtual"}};
}

}  // namespace palpate::faults
