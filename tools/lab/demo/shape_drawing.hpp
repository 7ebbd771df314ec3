#pragma once

#include <string>

#include "tools/lab/demo/demo.hpp"
#include "tools/lab/runs/experiments.hpp"

namespace palpate::demo {

/// Plots of shape error over time by method and model error, and an image of the pose with the
/// largest true displacement in `pictured`, the live run (nullptr: none).
void draw_sensing(const Demo& demo, const log::RunLog* pictured);

/// Plot of feature and target and of the error over time; image of start, target, true and
/// estimated shape at the end.
void draw_control(const Demo& demo, const scores::ScoredRun& scored, const log::RunLog& log,
                  const runs::ControlTarget& target);

/// Content of an image of one instant. All shapes in O.
struct Scene {
  const log::RunLog* log = nullptr;
  std::int64_t start_utime = 0;  // of the shape that is drawn pale
  std::int64_t utime = 0;        // of the true and the estimated shape, and of the arm
  const runs::ControlTarget* target = nullptr;
  std::string title;
};

/// Draws arm and hand, true shape (solid), estimate (mesh lines over it), shape at the start (pale)
/// and target (ball), with title and legend. Returns false, with one line on standard error, if no
/// image can be rendered.
bool draw_picture(const Demo& demo, const Scene& scene, const std::filesystem::path& png);

}  // namespace palpate::demo
