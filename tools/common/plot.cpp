#include "tools/common/plot.hpp"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"

namespace palpate::common {
namespace {

constexpr std::size_t kMostPoints = 2000;  // per curve; more are not visible

std::vector<double> thinned(const std::vector<double>& values) {
  const std::size_t step = std::max<std::size_t>(1, values.size() / kMostPoints);
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += step) result.push_back(values[i]);
  return result;
}

nlohmann::json to_json(const Plot& plot) {
  nlohmann::json json{{"title", plot.title},
                      {"x", plot.x_label},
                      {"y", plot.y_label},
                      {"logarithmic", plot.logarithmic},
                      {"logarithmic_x", plot.logarithmic_x}};
  for (const Curve& curve : plot.curves)
    json["curves"].push_back({{"name", curve.title},
                              {"x", thinned(curve.x)},
                              {"y", thinned(curve.y)},
                              {"dashed", curve.dashed}});
  return json;
}

}  // namespace

void draw(const std::vector<Plot>& plots, const std::filesystem::path& picture) {
  nlohmann::json json{{"file", std::filesystem::absolute(picture).string()}};
  for (const Plot& plot : plots) json["panels"].push_back(to_json(plot));
  const TemporaryFolder folder("palpate-plot");
  write_json(json, folder.path() / "plot.json");
  run_python("tools/common/plots.py", {(folder.path() / "plot.json").string()});
}

bool try_draw(const std::vector<Plot>& plots, const std::filesystem::path& picture) {
  try {
    draw(plots, picture);
    return true;
  } catch (const std::runtime_error& error) {
    std::cerr << "no " << picture.string() << ": " << error.what() << '\n';
    return false;
  }
}

}  // namespace palpate::common
