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

/// What an estimator made of one poke that nothing measures, held against the plant's truth.
struct PokeScore {
  scenes::Poke poke;
  /// s since it began, when the true wrench on the hand at the sensor has changed by more than five
  /// deviations of the sensor's noise (sim/sensors/sensors.yaml); none: it never has.
  std::optional<double> felt;
  std::optional<double> found;  // s since it was felt (since it began, where it never was)
  std::optional<double> gone;   // s since it ended, until no contact is told any more
  /// Means over the last half second of the full force; none where no contact was told then.
  std::optional<double> place;  // m, off
  std::optional<double> force;  // N, off
  /// Share of that time in which the place was said to be observable.
  std::optional<double> observable;
  /// Shape errors, mean over the nodes and worst node, m: over the half second before, the largest
  /// since it began, and half a second and a second after it was found.
  struct Error {
    double mean = 0;
    double worst = 0;
  };
  Error before, largest;
  std::optional<Error> half_second, second;
};

struct PokeScores {
  std::vector<PokeScore> pokes;
  std::vector<double> false_alarms;  // s, contacts that begin where nobody pokes
  double quiet = 0;                  // s without a poke
};

/// Throws std::runtime_error where the log lacks truth or estimate at one of `pokes`.
PokeScores score_pokes(const std::vector<scenes::Poke>& pokes, const log::RunLog& log,
                       const scores::ShapeScore& shape, const registry::Frames& frames);

/// `length`: of the object's largest side, m.
nlohmann::json to_json(const PokeScores& scores, double length);

/// Of an application's runs, over pokes and seeds: a row a method and model error; no rows where
/// nobody poked.
ReportTable poke_table(const StudyApplication& application,
                       const std::vector<StudyResult>& results);
/// The same poke by poke.
ReportTable each_poke_table(const StudyApplication& application,
                            const std::vector<StudyResult>& results);

}  // namespace palpate::studies
