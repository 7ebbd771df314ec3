#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "rt/registry/frames.hpp"
#include "sim/scenes/pokes.hpp"
#include "tools/lab/scores/shape_score.hpp"
#include "tools/lab/studies/study_tables.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// Estimate of one unmeasured external contact (poke), compared with the plant's ground truth.
struct PokeScore {
  scenes::Poke poke;
  /// s since its start, when the true wrench on the hand at the sensor has changed by more than
  /// five standard deviations of the sensor's noise (sim/sensors/sensors.yaml); empty: it never
  /// did.
  std::optional<double> felt;
  std::optional<double> found;  // s since it was measurable (since its start, if it never was)
  std::optional<double> gone;   // s since its end, until no contact is reported any more
  /// Means over the last half second of the full force; empty if no contact was reported then.
  std::optional<double> place;  // m, error
  std::optional<double> force;  // N, error
  /// Fraction of that time in which the contact point was reported as observable.
  std::optional<double> observable;
  /// Shape errors, mean over the nodes and worst node, m: over the half second before, the maximum
  /// since its start, and half a second and a second after it was detected.
  struct Error {
    double mean = 0;
    double worst = 0;
  };
  Error before, largest;
  std::optional<Error> half_second, second;
};

struct PokeScores {
  std::vector<PokeScore> pokes;
  std::vector<double> false_alarms;  // s, reported contacts that begin without a poke
  double quiet = 0;                  // s without a poke
};

/// X_OP: pose of the plant's O (P) in palpated's O. Throws std::runtime_error if the log lacks
/// truth or estimate at one of `pokes`.
PokeScores score_pokes(const std::vector<scenes::Poke>& pokes, const log::RunLog& log,
                       const scores::ShapeScore& shape, const registry::Frames& frames,
                       const math::Pose& X_OP = math::Pose::Identity());

/// `length`: largest side of the object, m.
nlohmann::json to_json(const PokeScores& scores, double length);

/// Over pokes and seeds of an application's runs: one row per method and model error; empty if
/// there were no pokes.
ReportTable poke_table(const StudyApplication& application,
                       const std::vector<StudyResult>& results);
/// The same poke by poke.
ReportTable each_poke_table(const StudyApplication& application,
                            const std::vector<StudyResult>& results);

}  // namespace palpate::studies
