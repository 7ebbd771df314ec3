#pragma once

#include <vector>

#include "tools/lab/faults/judge.hpp"

namespace palpate::faults {

/// Every row of the table of faults that can be tested in virtual time, in order. Rows that need
/// processes, other machines or hours are in rows_elsewhere().
std::vector<Row> all_rows();

/// Rows by subject.
std::vector<Row> message_rows();        // loss, order, duplicates, type
std::vector<Row> sensor_rows();         // numbers, stops, frozen, clocks, restarts
std::vector<Row> component_rows();      // errors, overruns, replacement
std::vector<Row> mechanics_rows();      // inverted elements, non-convergence
std::vector<Row> configuration_rows();  // errors in files

/// Rows that are tested elsewhere, and where.
struct Elsewhere {
  std::string number, fault, where;
};
std::vector<Elsewhere> rows_elsewhere();

}  // namespace palpate::faults
