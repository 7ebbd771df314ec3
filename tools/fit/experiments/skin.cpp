#include "tools/fit/experiments/skin.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/solid/solid_membrane.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector2d;
using solid::kMembraneParameters;
using solid::MembraneVector;
using solid::SolidMembrane;

/// Lines through `stops`, at most `cell` apart between the inner ones and growing outside.
std::vector<double> grid_lines(const std::vector<double>& stops, double cell, double margin) {
  std::vector<double> lines;
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    const int cells = std::max(1, static_cast<int>(std::ceil((stops[k + 1] - stops[k]) / cell)));
    for (int i = 0; i < cells; ++i) {
      lines.push_back(stops[k] + (stops[k + 1] - stops[k]) * i / cells);
    }
  }
  lines.push_back(stops.back());
  // Three sizes of cells, each twice the previous, fill the margin.
  for (double share : {1. / 7, 3. / 7, 1.}) {
    lines.push_back(stops.back() + share * margin);
    lines.insert(lines.begin(), stops.front() - share * margin);
  }
  return lines;
}

class Membrane final : public Experiment {
 public:
  Membrane(const config::Node& node, const std::filesystem::path& folder) {
    const Recording field(node, folder,
                          {{"frame", Dimension::kRatio, "number of the picture"},
                           {"point", Dimension::kRatio, "number of the point that is followed"},
                           {"x", Dimension::kLength, "of the point"},
                           {"y", Dimension::kLength, "of the point"}});
    const Recording pads(node.child({"pads", "", "recording of the pads and their force"}), folder,
                         {{"frame", Dimension::kRatio, "number of the picture"},
                          {"moving_x", Dimension::kLength, "by which the one pad has moved"},
                          {"moving_y", Dimension::kLength, "by which the one pad has moved"},
                          {"fixed_x", Dimension::kLength, "of the other pad, from the first"},
                          {"fixed_y", Dimension::kLength, "of the other pad, from the first"},
                          {"force", Dimension::kForce, "on the pad that moves"}});
    name_ = field.name();
    pads.require_varying("moving_x");
    pads.require_varying("force");
    read_frames(node.child({"frames", "", "which are used"}), pads);
    build(node.child({"geometry", "", "of pads and mesh"}), pads);
    read_field(node.integer({"every", "", "each so-and-so-many-th point"}, {1, 1000}, 1), field);
    read_series(node.child_or_empty({"deviations", "", "standard, of what is measured"}));
    parameters_ = {{"shear_thickness", "N/m", 5, 1e-3, 1e5, true},
                   {"fung_exponent", "", 5, 1e-3, 1e4, true},
                   {"fibre_thickness", "N/m", 2, 1e-4, 1e5, true},
                   {"fibre_angle", "rad", -0.2, -3.2, 3.2},
                   {"foundation", "N/m^3", 1e4, 1, 1e9, true},
                   {"foundation_grip", "m", 1e-3, 1e-5, 1, true}};
  }

  std::string material() const override { return "fung_membrane"; }

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    const auto points = static_cast<Eigen::Index>(places_.size());
    const auto frames = static_cast<Eigen::Index>(frames_.size());
    prediction.resize(frames * (2 * points + 1));
    if (jacobian) jacobian->resize(prediction.size(), kMembraneParameters);
    SolidMembrane::State state;
    const MembraneVector p = parameters;
    for (Eigen::Index k = 0; k < frames; ++k) {
      if (!membrane_->solve(p, {frames_[k].motion, Vector2d::Zero()}, state, jacobian != nullptr))
        return false;
      for (Eigen::Index i = 0; i < points; ++i) {
        const SolidMembrane::Place& place = places_[i];
        const Eigen::Index row = 2 * (k * points + i);
        prediction.segment<2>(row).setZero();
        if (jacobian) jacobian->middleRows<2>(row).setZero();
        for (int a = 0; a < 9; ++a) {
          prediction.segment<2>(row) += place.weights[a] * state.u.segment<2>(2 * place.nodes[a]);
          if (!jacobian) continue;
          jacobian->middleRows<2>(row) +=
              place.weights[a] * state.slopes.middleRows<2>(2 * place.nodes[a]);
        }
      }
      remove_drift(prediction.segment(2 * k * points, 2 * points));
      for (int c = 0; jacobian && c < kMembraneParameters; ++c) {
        remove_drift(jacobian->col(c).segment(2 * k * points, 2 * points));
      }
      const Eigen::Index row = 2 * frames * points + k;
      prediction[row] = state.forces[0].x();
      if (jacobian) jacobian->row(row) = state.force_slopes[0].row(0);
    }
    return true;
  }

  std::vector<Finding> findings(const Eigen::VectorXd& parameters) const override {
    Eigen::VectorXd prediction;
    if (last_fitted_ < 0 || !predict(parameters, prediction, nullptr)) return {};
    const Eigen::VectorXd& measured = measured_;
    const auto length = static_cast<Eigen::Index>(2 * places_.size());
    const auto of = [&](const Eigen::VectorXd& all, Eigen::Index frame) {
      return all.segment(frame * length, length);
    };
    double linear = 0, alone = 0, carried = 0;
    int count = 0;
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(frames_.size()); ++k) {
      if (!frames_[k].is_predicted) continue;
      const double scale = frames_[k].motion.x() / frames_[last_fitted_].motion.x();
      const Eigen::VectorXd truth = of(measured, k), model = of(prediction, k),
                            proportional = scale * of(measured, last_fitted_);
      const Eigen::VectorXd departure = model - scale * of(prediction, last_fitted_);
      Eigen::VectorXd error = model - truth;
      remove_drift(error);
      linear += (proportional - truth).squaredNorm();
      alone += error.squaredNorm();
      carried += (proportional + departure - truth).squaredNorm();
      ++count;
    }
    if (count == 0) return {};
    const double samples = count * static_cast<double>(places_.size());
    const double reference = std::sqrt(linear / samples);
    return {
        {"field, model alone, drift left out", "m", reference, std::sqrt(alone / samples)},
        {"field, last frame carried on", "m", reference, std::sqrt(carried / samples), 0, true}};
  }

 private:
  /// Subtracts the mean of the y components: lateral drift of the whole limb, which is not caused
  /// by the pads.
  static void remove_drift(Eigen::Ref<Eigen::VectorXd> field) {
    double mean = 0;
    const Eigen::Index count = field.size() / 2;
    for (Eigen::Index i = 0; i < count; ++i) mean += field[2 * i + 1] / static_cast<double>(count);
    for (Eigen::Index i = 0; i < count; ++i) field[2 * i + 1] -= mean;
  }

  struct Frame {
    int number = 0;
    bool is_predicted = false;
    Vector2d motion;   // m
    double force = 0;  // N
  };

  void read_frames(const config::Node& node, const Recording& pads) {
    std::map<int, bool> wanted;
    for (double f : node.numbers({"fitted", "", "frames"}, -1, {0, 1e6}))
      wanted[static_cast<int>(f)] = false;
    for (double f : node.numbers({"predicted", "", "frames that are held out"}, -1, {0, 1e6}))
      wanted[static_cast<int>(f)] = true;
    for (const auto& [number, is_predicted] : wanted) {
      Frame frame;
      frame.number = number;
      frame.is_predicted = is_predicted;
      Eigen::Index row = 0;
      while (row < pads.rows() && pads.column("frame")[row] != number) ++row;
      if (row == pads.rows()) pads.fail("there is no frame " + std::to_string(number));
      frame.motion << pads.column("moving_x")[row], pads.column("moving_y")[row];
      frame.force = pads.column("force")[row];
      if (!is_predicted && frame.motion.x() != 0) {
        last_fitted_ = static_cast<Eigen::Index>(frames_.size());
      }
      if (frame.force * frame.motion.x() < 0) {
        pads.fail(row, "the pad's force points against its motion; give its column `sign: -1`");
      }
      frames_.push_back(frame);
    }
    if (last_fitted_ < 0) node.fail("fitted", "needs a frame in which the pad has moved");
  }

  void build(const config::Node& geometry, const Recording& pads) {
    const auto length = [&](const config::Key& key) {
      return read_quantity(geometry, key, Dimension::kLength, {1e-4, 1});
    };
    const double width = length({"pad_width", "", "across the motion"}),
                 reach = length({"pad_length", "", "along the motion"}),
                 margin = length({"margin", "", "of skin around the pads"}),
                 cell = length({"cell", "", "of the mesh"});
    const double far = pads.column("fixed_x")[0], axis = pads.column("fixed_y")[0] / 2;
    if (!(far > cell)) pads.fail(0, "the fixed pad must lie at a greater x than the moving one");
    const double low = axis - width / 2, high = axis + width / 2;
    membrane_ = std::make_unique<SolidMembrane>(
        grid_lines({-reach, 0, far, far + reach}, cell, margin),
        grid_lines({low, high}, cell, margin),
        std::vector<solid::Rectangle>{{{-reach, low}, {0, high}},
                                      {{far, low}, {far + reach, high}}});
  }

  void read_field(int every, const Recording& field) {
    std::map<int, std::map<int, Vector2d>> positions;  // by frame and point
    const Eigen::VectorXd &frame = field.column("frame"), &point = field.column("point");
    for (Eigen::Index i = 0; i < field.rows(); ++i) {
      positions[static_cast<int>(frame[i])][static_cast<int>(point[i])] << field.column("x")[i],
          field.column("y")[i];
    }
    const std::map<int, Vector2d>& reference = positions.begin()->second;
    std::vector<int> used;
    for (const auto& [number, at] : reference) {
      if (number % every != 0) continue;
      used.push_back(number);
      places_.push_back(membrane_->locate(at));
    }
    if (used.empty()) field.fail("no point is used: lower `every`");
    measured_.resize(static_cast<Eigen::Index>(2 * used.size() * frames_.size()));
    Eigen::Index row = 0;
    for (const Frame& f : frames_) {
      for (int number : used) {
        const auto seen = positions.find(f.number);
        if (seen == positions.end() || seen->second.count(number) == 0) {
          field.fail("frame " + std::to_string(f.number) + " lacks point " +
                     std::to_string(number));
        }
        measured_.segment<2>(row) = seen->second.at(number) - reference.at(number);
        row += 2;
      }
    }
  }

  void read_series(const config::Node& deviations) {
    const auto points = static_cast<Eigen::Index>(places_.size());
    const auto frames = static_cast<Eigen::Index>(frames_.size());
    Series field{"field_displacement", "m", "frame", "", {}, measured_};
    field.x.resize(measured_.size());
    field.deviation =
        read_quantity(deviations, {"field", "", "of a point"}, Dimension::kLength, {1e-9, 1}, 2e-5);
    Series force{"pad_force", "N", "pad_displacement", "m"};
    force.x.resize(frames);
    force.measured.resize(frames);
    force.deviation = read_quantity(deviations, {"force", "", "of the pad"}, Dimension::kForce,
                                    {1e-9, 1e3}, 5e-4);
    for (Eigen::Index k = 0; k < frames; ++k) {
      field.x.segment(2 * points * k, 2 * points).setConstant(frames_[k].number);
      force.x[k] = frames_[k].motion.x();
      force.measured[k] = frames_[k].force;
      remove_drift(field.measured.segment(2 * points * k, 2 * points));
      force.is_held_out.push_back(frames_[k].is_predicted);
      field.is_held_out.insert(field.is_held_out.end(), static_cast<std::size_t>(2 * points),
                               frames_[k].is_predicted);
    }
    series_ = {field, force};
  }

  std::vector<Frame> frames_;
  Eigen::Index last_fitted_ = -1;  // among frames_
  std::unique_ptr<SolidMembrane> membrane_;
  std::vector<SolidMembrane::Place> places_;
  Eigen::VectorXd measured_;
};

}  // namespace

std::unique_ptr<Experiment> make_membrane(const config::Node& node,
                                          const std::filesystem::path& folder) {
  return std::make_unique<Membrane>(node, folder);
}

}  // namespace palpate::fit
