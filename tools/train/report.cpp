#include "tools/train/report.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/math/constants.hpp"
#include "rt/inference/torch_module.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/table.hpp"

namespace palpate::train {
namespace {

using math::kDegree;

/// Predictions minus the mean error over the first seconds of each recording.
std::vector<Eigen::MatrixXd> tare_again(const recordings::DataSet& data,
                                        std::vector<Eigen::MatrixXd> list, double seconds) {
  for (std::size_t r = 0; r < list.size(); ++r) {
    const recordings::Recording& recording = data.recordings[r];
    Eigen::Index rows = 0;
    while (rows < recording.time.size() && recording.time[rows] < seconds) ++rows;
    if (rows == 0) continue;
    const Eigen::RowVectorXd mean =
        (list[r].topRows(rows) - recording.outputs.topRows(rows)).colwise().mean();
    list[r].rowwise() -= mean;
  }
  return list;
}

const char* part_name(recordings::Part part) {
  return part == recordings::Part::kTest ? "test" : "validation";
}

template <class List>
YAML::Node flow(const List& values) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (const auto& value : values) node.push_back(value);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node intervals(const std::vector<recordings::Interval>& list) {
  std::vector<double> ends;
  for (const recordings::Interval& interval : list) {
    ends.push_back(interval.begin);
    ends.push_back(interval.end);
  }
  return flow(ends);
}

YAML::Node to_yaml(const Method& method, const std::vector<recordings::ColumnGroup>& outputs) {
  YAML::Node node;
  node["method"] = method.name;
  if (method.tared) node["tared"] = true;
  node["rows"] = method.errors.rows;
  node["rms"] = flow(method.errors.rms);
  node["mean_absolute"] = flow(method.errors.mean_absolute);
  node["correlation"] = flow(method.errors.correlation);
  for (std::size_t g = 0; g < outputs.size(); ++g) {
    node[outputs[g].name + "_rms"] = method.errors.norms[g];
    node[outputs[g].name + "_length_rms"] = method.errors.lengths[g];
    if (!outputs[g].is_direction) continue;
    node[outputs[g].name + "_median_angle"] = method.errors.median_angle[g];
    node[outputs[g].name + "_angle_90"] = method.errors.angle_90[g];
  }
  return node;
}

}  // namespace

Score score_fit(const recordings::Plan& plan, const recordings::DataSet& data, const Fit& fit) {
  Score score;
  const std::vector<Eigen::MatrixXd> truth = recordings::outputs_of(data);
  if (recordings::gather(data, truth, recordings::Part::kTest).rows() == 0)
    score.part = recordings::Part::kValidation;
  const Eigen::MatrixXd scored = recordings::gather(data, truth, score.part);
  const Eigen::MatrixXd trained = recordings::gather(data, truth, recordings::Part::kTraining);
  score.largest_scored = scored.cwiseAbs().colwise().maxCoeff().transpose();
  score.largest_trained = trained.cwiseAbs().colwise().maxCoeff().transpose();

  const auto add = [&](const std::string& name, std::vector<Eigen::MatrixXd> predictions) {
    const auto measure = [&](const std::vector<Eigen::MatrixXd>& list) {
      return recordings::measure_errors(recordings::gather(data, list, score.part), scored,
                                        plan.data.outputs);
    };
    score.methods.push_back({name, predictions, measure(predictions), false});
    if (!plan.data.is_wrist || plan.data.retare <= 0) return;
    predictions = tare_again(data, std::move(predictions), plan.data.retare);
    score.methods.push_back({name, predictions, measure(predictions), true});
  };
  add(plan.name, predict(fit.network, data, 0, fit.domain));
  if (!plan.training.carry)
    add(plan.name + ", windows", predict(fit.network, data, plan.training.steps));
  add("ridge", predict(fit.linear, data));
  if (plan.data.is_wrist) {
    std::vector<Eigen::MatrixXd> analytic;
    for (const recordings::Recording& recording : data.recordings)
      analytic.push_back(recording.analytic);
    add("newton_euler", analytic);
  } else {
    std::vector<Eigen::MatrixXd> mean;
    for (const Eigen::MatrixXd& rows : truth)
      mean.push_back(trained.colwise().mean().replicate(rows.rows(), 1));
    add("mean", mean);
  }
  return score;
}

void print_score(const recordings::Plan& plan, const recordings::DataSet& data, const Score& score,
                 std::ostream& out) {
  std::vector<std::string> header{"method", "tare"};
  for (const inference::Channel& channel : data.outputs)
    header.push_back(channel.name + " " + channel.unit);
  for (const recordings::ColumnGroup& group : plan.data.outputs) {
    header.push_back("|" + group.name + "| " + group.unit);
    header.push_back("its length");
    if (group.is_direction) header.insert(header.end(), {"median deg", "90 % deg"});
  }
  common::Table table(header);
  for (const Method& method : score.methods) {
    std::vector<std::string> row{method.name, method.tared ? "again" : ""};
    for (const double rms : method.errors.rms) row.push_back(common::number(rms, 4));
    for (std::size_t g = 0; g < plan.data.outputs.size(); ++g) {
      row.push_back(common::number(method.errors.norms[g], 4));
      row.push_back(common::number(method.errors.lengths[g], 4));
      if (!plan.data.outputs[g].is_direction) continue;
      row.push_back(common::number(method.errors.median_angle[g] / kDegree, 2));
      row.push_back(common::number(method.errors.angle_90[g] / kDegree, 2));
    }
    table.add(row);
  }
  out << "RMS errors on " << score.methods.front().errors.rows << " rows of the "
      << part_name(score.part) << " part\n";
  table.print(out);
  const recordings::Errors trained = recordings::measure_errors(
      recordings::gather(data, score.methods.front().predictions, recordings::Part::kTraining),
      recordings::gather(data, recordings::outputs_of(data), recordings::Part::kTraining),
      plan.data.outputs);
  out << score.methods.front().name << " on its training part:";
  for (std::size_t g = 0; g < plan.data.outputs.size(); ++g)
    out << "  |" << plan.data.outputs[g].name << "| " << common::number(trained.norms[g], 4) << " "
        << plan.data.outputs[g].unit;
  out << "\nlargest magnitude, scored / trained:";
  for (std::size_t i = 0; i < data.outputs.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    out << "  " << data.outputs[i].name << " " << common::number(score.largest_scored[k], 3)
        << " / " << common::number(score.largest_trained[k], 3);
  }
  out << "\n";
  for (const inference::StreamDelay& delay : data.delays)
    out << delay.stream << " lags behind the pose by " << common::number(1e3 * delay.seconds, 1)
        << " ms\n";
  if (data.payload) {
    const Eigen::Vector3d centre = 1e3 * data.payload->center_of_mass();
    out << "payload " << common::number(data.payload->mass, 3) << " kg, centre "
        << common::number(centre.x(), 1) << " " << common::number(centre.y(), 1) << " "
        << common::number(centre.z(), 1) << " mm\n";
  }
}

inference::ModelCard make_card(const recordings::Plan& plan, const recordings::DataSet& data,
                               const Fit& fit, const Score& score) {
  inference::ModelCard card;
  card.name = plan.name;
  card.rate = plan.data.rate;
  card.average = plan.data.average;
  card.inputs = data.inputs;
  card.outputs = data.outputs;
  if (plan.data.target == recordings::Target::kResidual) card.payload = data.payload;
  card.domain = fit.domain;
  card.delays = data.delays;

  YAML::Node training;
  training["palpate"] = PALPATE_VERSION;
  training["libtorch"] = inference::torch_version();
  training["seed"] = plan.training.seed;
  training["layers"] = flow(plan.network.layers);
  training["linear_path"] = plan.network.linear;
  training["ridge_penalty"] = flow(fit.penalty);
  training["trusted_part_of_cells"] = flow(fit.trust);
  training["best_iteration"] = fit.best_iteration;
  training["refit_on_all_parts"] = plan.training.refit;
  for (std::size_t i = 0; i < data.files.size(); ++i) {
    YAML::Node file;
    file["file"] = data.files[i].file;
    file["sha256"] = data.files[i].sha256;
    file["validation_seconds"] = intervals(plan.data.recordings[i].validation);
    file["test_seconds"] = intervals(plan.data.recordings[i].test);
    training["data"].push_back(file);
  }
  training["scored_part"] = part_name(score.part);
  training["largest_magnitude_trained"] = flow(score.largest_trained);
  training["largest_magnitude_scored"] = flow(score.largest_scored);
  for (const Method& method : score.methods)
    training["errors"].push_back(to_yaml(method, plan.data.outputs));
  card.training = training;
  return card;
}

bool draw_fit(const recordings::Plan& plan, const recordings::DataSet& data, const Fit& fit,
              const Score& score, const std::string& picture) {
  std::vector<common::Plot> plots;
  common::Plot curve{
      plan.name + ": learning curve",
      "iteration",
      "mean squared error, scaled",
      {{"training, of what the cells learn", {}, {}}, {"validation, of the outputs", {}, {}}},
      true};
  for (const CurvePoint& point : fit.curve) {
    if (std::isfinite(point.training)) {
      curve.curves[0].x.push_back(point.iteration);
      curve.curves[0].y.push_back(point.training);
    }
    if (!std::isfinite(point.validation)) continue;
    curve.curves[1].x.push_back(point.iteration);
    curve.curves[1].y.push_back(point.validation);
  }
  const auto is_empty = [](const common::Curve& c) { return c.x.empty(); };
  curve.curves.erase(std::remove_if(curve.curves.begin(), curve.curves.end(), is_empty),
                     curve.curves.end());
  if (!curve.curves.empty()) plots.push_back(curve);

  for (std::size_t r = 0; r < data.recordings.size(); ++r) {
    const recordings::Recording& recording = data.recordings[r];
    const bool has_part = std::find(recording.parts.begin(), recording.parts.end(), score.part) !=
                          recording.parts.end();
    if (!has_part) continue;
    Eigen::Index column = 0;
    for (const recordings::ColumnGroup& group : plan.data.outputs) {
      common::Plot plot{recording.name + ": " + group.name, "s", group.unit, {}};
      for (const std::string& name : group.columns) {
        common::Curve truth{name, {}, {}};
        common::Curve answer{name + " predicted", {}, {}, true};
        for (Eigen::Index k = 0; k < recording.time.size(); ++k) {
          if (recording.parts[static_cast<std::size_t>(k)] != score.part) continue;
          truth.x.push_back(recording.time[k]);
          answer.x.push_back(recording.time[k]);
          truth.y.push_back(recording.outputs(k, column));
          answer.y.push_back(score.methods.front().predictions[r](k, column));
        }
        plot.curves.push_back(truth);
        plot.curves.push_back(answer);
        ++column;
      }
      plots.push_back(plot);
    }
  }
  return common::try_draw(plots, picture);
}

}  // namespace palpate::train
