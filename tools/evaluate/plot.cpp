#include "tools/evaluate/plot.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/evaluate/process.hpp"

namespace palpate::evaluate {
namespace {

constexpr int kMostPoints = 2000;       // a curve; more cannot be seen
constexpr std::size_t kFewPoints = 12;  // are marked one by one
constexpr int kWidth = 1100, kHeight = 420;

bool is_installed(const std::string& program) {
  std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (std::filesystem::exists(std::filesystem::path(folder) / program)) return true;
  return false;
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

void write_data(std::ostream& out, const Curve& curve) {
  const std::size_t step = std::max<std::size_t>(1, curve.x.size() / kMostPoints);
  for (std::size_t i = 0; i < curve.x.size(); i += step)
    out << curve.x[i] << ' ' << curve.y[i] << '\n';
}

void write_plot(std::ostream& out, const Plot& plot, int& block) {
  out << "set title " << quoted(plot.title) << "\nset xlabel " << quoted(plot.x_label)
      << "\nset ylabel " << quoted(plot.y_label) << '\n'
      << (plot.logarithmic ? "set logscale y\n" : "unset logscale y\n")
      << (plot.logarithmic_x ? "set logscale x\n" : "unset logscale x\n");
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    out << "$data" << block + static_cast<int>(i) << " << EOD\n";
    write_data(out, plot.curves[i]);
    out << "EOD\n";
  }
  out << "plot ";
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    const Curve& curve = plot.curves[i];
    const int colour = curve.colour > 0 ? curve.colour : static_cast<int>(i) + 1;
    out << (i == 0 ? "" : ", ") << "$data" << block + static_cast<int>(i) << " using 1:2 with "
        << (curve.x.size() <= kFewPoints ? "linespoints" : "lines") << " linewidth 2 linetype "
        << colour << (curve.dashed ? " dashtype 2" : "") << " title " << quoted(curve.title);
  }
  out << '\n';
  block += static_cast<int>(plot.curves.size());
}

}  // namespace

bool draw(const std::vector<Plot>& plots, const std::filesystem::path& picture) {
  if (!is_installed("gnuplot")) return false;
  std::filesystem::path script = picture, messages = picture;
  script.replace_extension(".gnuplot");
  messages.replace_extension(".gnuplot-messages");
  {
    std::ofstream out(script);
    out << "set terminal " << (picture.extension() == ".svg" ? "svg" : "pngcairo")
        << " noenhanced size " << kWidth << ',' << kHeight * static_cast<int>(plots.size())
        << "\nset output " << quoted(picture.string())
        << "\nset grid\nset key outside right top\n"
        // All as wide, whatever their legends: times stand above each other.
        << "set lmargin at screen 0.08\nset rmargin at screen 0.66\nset multiplot layout "
        << plots.size() << ",1\n";
    int block = 0;
    for (const Plot& plot : plots) write_plot(out, plot, block);
    out << "unset multiplot\n";
    if (!out) throw std::runtime_error("cannot write " + script.string());
  }
  const int code = run_to_end({"gnuplot", script.string()}, messages, 60);
  if (code != 0)
    throw std::runtime_error("gnuplot failed on " + script.string() + ":\n" + tail(messages, 10));
  std::filesystem::remove(messages);
  std::filesystem::remove(script);
  return true;
}

}  // namespace palpate::evaluate
