#include "tools/lab/demo/shape_drawing.hpp"

#include <algorithm>

#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/lab/runs/live_run.hpp"

namespace palpate::demo {
namespace {

common::Curve shape_error_curve(const scores::ScoredRun& run) {
  common::Curve curve{run.name, {}, {}, false};
  for (const scores::ShapeErrorSample& sample : run.shape->samples) {
    curve.x.push_back(sample.time);
    curve.y.push_back(std::max(1e-3, sample.mean * 1e3));
  }
  return curve;
}

/// Along the line to the target, from the rest shape, mm.
common::Curve way_curve(const std::string& title,
                        const std::vector<scores::FeatureErrorSample>& samples,
                        const runs::ControlTarget& target) {
  const Eigen::Vector3d direction = target.displacement.normalized();
  const Eigen::Vector3d rest = target.values.head<3>() - target.displacement;
  common::Curve curve{title, {}, {}, false};
  for (const scores::FeatureErrorSample& sample : samples) {
    curve.x.push_back(sample.time);
    curve.y.push_back((sample.position - rest).dot(direction) * 1e3);
  }
  return curve;
}

common::Curve distance_curve(const std::string& title,
                             const std::vector<scores::FeatureErrorSample>& samples) {
  common::Curve curve{title, {}, {}, false};
  for (const scores::FeatureErrorSample& sample : samples) {
    curve.x.push_back(sample.time);
    curve.y.push_back(std::max(1e-2, sample.distance * 1e3));
  }
  return curve;
}

common::Curve level(const std::string& title, double value, double end) {
  return {title, {0, end}, {value, value}, true};
}

}  // namespace

void draw_sensing(const Demo& demo, const log::RunLog* pictured) {
  std::vector<common::Plot> plots;
  std::vector<std::string> levels;
  for (const scores::ScoredRun& run : demo.scored)
    if (std::find(levels.begin(), levels.end(), run.mismatch) == levels.end())
      levels.push_back(run.mismatch);
  for (const std::string& name : levels) {
    common::Plot plot{
        "Mean shape error, six poses, model error: " + name, "time, s", "mm", {}, true};
    for (const scores::ScoredRun& run : demo.scored)
      if (run.shape && run.mismatch == name) plot.curves.push_back(shape_error_curve(run));
    if (!plot.curves.empty()) plots.push_back(plot);
  }
  if (!plots.empty()) common::try_draw(plots, demo.options.output / "sensing_shape_error.png");
  if (pictured == nullptr) return;

  const scores::ShapeScore score = scores::score_shape(*pictured);
  const auto furthest =
      std::max_element(score.holds.begin(), score.holds.end(),
                       [](const scores::HoldScore& a, const scores::HoldScore& b) {
                         return a.displacement < b.displacement;
                       });
  if (furthest == score.holds.end()) return;
  const std::int64_t start = pictured->shapes.front().utime;
  const auto end = start + static_cast<std::int64_t>(furthest->end * 1e6);
  draw_picture(demo, {pictured, start, end, nullptr, "Shape sensing, the pose farthest from rest"},
               demo.options.output / "sensing.png");
}

void draw_control(const Demo& demo, const scores::ScoredRun& scored, const log::RunLog& log,
                  const runs::ControlTarget& target) {
  const scores::FeatureScore& feature = *scored.feature;
  const double end = feature.samples.back().time;
  const std::string title = target.name + ", model error: " + scored.mismatch;
  const common::Plot way{title,
                         "time, s",
                         "way to the target, mm",
                         {way_curve("plant", feature.samples, target),
                          way_curve("estimate", feature.estimated, target),
                          level("target", target.displacement.norm() * 1e3, end)},
                         false};
  const common::Plot error{"Distance to the target",
                           "time, s",
                           "mm",
                           {distance_curve("plant", feature.samples),
                            distance_curve("estimate", feature.estimated), level("5 mm", 5, end)},
                           true};
  const std::string name = "control_" + common::file_name(target.name) + "_" + scored.mismatch;
  common::try_draw({way, error}, demo.options.output / (name + "_plot.png"));
  const std::int64_t start = log.targets.front().utime;
  draw_picture(demo, {&log, start, log.shapes.back().utime, &target, "Shape control, " + title},
               demo.options.output / (name + ".png"));
}

}  // namespace palpate::demo
