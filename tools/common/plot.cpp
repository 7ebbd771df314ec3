#include "tools/common/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "tools/common/process.hpp"
#include "tools/common/table.hpp"

namespace palpate::common {
namespace {

constexpr int kMostPoints = 2000;       // per curve; more are not visible
constexpr std::size_t kFewPoints = 12;  // are marked individually
constexpr int kWidth = 1100, kHeight = 420;

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

/// A label on an axis, where % introduces a format.
std::string tic_label(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '%' ? std::string("%%") : std::string(1, c);
  const std::string& label = escaped;
  return quoted(label);
}

/// A field is white if its fraction is zero; any other fraction is distinguishable from that.
void write_field(std::ostream& out, const ColourMatrix& matrix, int row, int column, int object) {
  const double share = matrix.shares[row][column];
  const double strength = share > 0 ? 0.2 + 0.8 * share : 0;
  unsigned colour = 0;
  for (const int shift : {16, 8, 0}) {
    const double full = static_cast<double>(matrix.colours[column] >> shift & 0xffU);
    colour |= static_cast<unsigned>(255 + strength * (full - 255)) << shift;
  }
  out << "set object " << object << " rectangle from " << column << ',' << row << " to "
      << column + 1 << ',' << row + 1 << " fillcolor rgb '#" << formatted("%06x", colour)
      << "' fillstyle solid border rgb '#c0c0c0'\n";
  if (share > 0)
    out << "set label " << object << " '" << 100 * share << "' at " << column + 0.5 << ','
        << row + 0.5 << " center front\n";
}

/// Runs gnuplot on the output of `write`, `height` pixels high.
bool run_gnuplot(const std::filesystem::path& picture, int height,
                 const std::function<void(std::ostream&)>& write) {
  if (!is_installed("gnuplot")) return false;
  std::filesystem::path script = picture, messages = picture;
  script.replace_extension(".gnuplot");
  messages.replace_extension(".gnuplot-messages");
  {
    std::ofstream out(script);
    out << "set terminal " << (picture.extension() == ".svg" ? "svg" : "pngcairo")
        << " noenhanced size " << kWidth << ',' << height << "\nset output "
        << quoted(picture.string()) << '\n';
    write(out);
    if (!out) throw std::runtime_error("cannot write " + script.string());
  }
  const int code = run_to_end({"gnuplot", script.string()}, messages, 60);
  if (code != 0)
    throw std::runtime_error("gnuplot failed on " + script.string() + ":\n" + tail(messages, 10));
  std::filesystem::remove(messages);
  std::filesystem::remove(script);
  return true;
}

}  // namespace

bool draw(const std::vector<Plot>& plots, const std::filesystem::path& picture) {
  return run_gnuplot(picture, kHeight * static_cast<int>(plots.size()), [&](std::ostream& out) {
    out << "set grid\nset key outside right top\n"
        // Equal widths regardless of legends, so that the time axes are aligned.
        << "set lmargin at screen 0.08\nset rmargin at screen 0.66\nset multiplot layout "
        << plots.size() << ",1\n";
    int block = 0;
    for (const Plot& plot : plots) write_plot(out, plot, block);
    out << "unset multiplot\n";
  });
}

bool draw(const ColourMatrix& matrix, const std::filesystem::path& picture) {
  constexpr int kRowHeight = 22, kBorder = 80;
  const auto rows = static_cast<int>(matrix.rows.size());
  return run_gnuplot(picture, kBorder + kRowHeight * rows, [&](std::ostream& out) {
    out << "set title " << quoted(matrix.title) << "\nunset key\nunset border\nset tics scale 0\n"
        << "set lmargin at screen 0.5\nset rmargin at screen 0.98\nset xrange [0:"
        << matrix.columns.size() << "]\nset yrange [" << rows << ":0]\nset xtics (";
    for (std::size_t i = 0; i < matrix.columns.size(); ++i)
      out << (i == 0 ? "" : ", ") << tic_label(matrix.columns[i]) << ' ' << i + 0.5;
    out << ")\nset ytics (";
    for (int i = 0; i < rows; ++i)
      out << (i == 0 ? "" : ", ") << tic_label(matrix.rows[i]) << ' ' << i + 0.5;
    out << ")\n";
    int object = 0;
    for (int row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < matrix.columns.size(); ++column)
        write_field(out, matrix, row, static_cast<int>(column), ++object);
    out << "plot -1\n";
  });
}

}  // namespace palpate::common
