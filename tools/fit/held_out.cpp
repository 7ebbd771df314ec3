#include "tools/fit/held_out.hpp"

#include <algorithm>

namespace palpate::fit {

std::vector<bool> selected_samples(const Selection& selection, const config::Node& node,
                                   const std::string& key, const Recording& recording,
                                   const NamedValues& others) {
  const auto count =
      static_cast<std::size_t>(others.empty() ? recording.rows() : others.front().second.size());
  if (selection.quantity.empty())
    return selection.is_all ? std::vector<bool>(count, true) : std::vector<bool>();
  Eigen::VectorXd values;
  const auto other = std::find_if(others.begin(), others.end(), [&](const auto& entry) {
    return entry.first == selection.quantity;
  });
  if (other != others.end()) {
    values = other->second;
  } else if (selection.quantity == "sample") {
    values.setLinSpaced(static_cast<Eigen::Index>(count), 0, static_cast<double>(count) - 1);
  } else if (recording.has(selection.quantity)) {
    values = recording.column(selection.quantity);
  } else {
    std::string known = "'sample'";
    for (const auto& entry : others) known += ", '" + entry.first + "'";
    node.fail(
        key, "knows no quantity '" + selection.quantity + "'; allowed: " + known + ", or a column");
  }
  std::vector<bool> selected(static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    selected[static_cast<std::size_t>(i)] = selection.holds(values[i]);
  return selected;
}

std::vector<bool> held_out_samples(const config::Node& node, const Recording& recording,
                                   const NamedValues& others) {
  return selected_samples(read_selection(node, kHeldOut, false), node, "held_out", recording,
                          others);
}

}  // namespace palpate::fit
