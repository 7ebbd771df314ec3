#include "tools/lab/sensor_models/sensors_baselines.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/sensing/electrode_scatter.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "tools/recordings/ridge.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::sensor_models {
namespace {

constexpr Eigen::Index kFewestRows = 50;
constexpr double kSensorsBaselinesGravity = 9.81;  // m/s^2

/// The inputs of the kind's plan, scaled as for its network.
class LinearMap {
 public:
  /// `inputs`: n x all inputs of a track.
  LinearMap(SensorKind kind, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs)
      : plan_(plan_of(kind)) {
    for (const std::string& column : recordings::columns_of(plan_.data.inputs))
      places_.push_back(input_place(kind, column));
    const Eigen::MatrixXd x = picked(inputs);
    mean_ = x.colwise().mean();
    deviation_ =
        ((x.rowwise() - mean_).colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt();
    Eigen::Index column = 0;
    for (const recordings::ColumnGroup& group : plan_.data.inputs)
      for (std::size_t i = 0; i < group.columns.size(); ++i, ++column)
        deviation_[column] = std::max(deviation_[column], group.floor);
    ridge_ = recordings::fit_ridge(scaled(x), outputs, plan_.network.penalties);
  }

  Eigen::MatrixXd operator()(const Eigen::MatrixXd& inputs) const {
    return ridge_.predict(scaled(picked(inputs)));
  }

 private:
  Eigen::MatrixXd picked(const Eigen::MatrixXd& inputs) const {
    Eigen::MatrixXd x(inputs.rows(), static_cast<Eigen::Index>(places_.size()));
    for (std::size_t i = 0; i < places_.size(); ++i)
      x.col(static_cast<Eigen::Index>(i)) = inputs.col(places_[i]);
    Eigen::Index first = 0;
    for (const recordings::ColumnGroup& group : plan_.data.inputs) {
      const auto count = static_cast<Eigen::Index>(group.columns.size());
      if (group.unit_length > 0)
        for (Eigen::Index k = 0; k < x.rows(); ++k)
          x.row(k).segment(first, count) /=
              std::hypot(x.row(k).segment(first, count).norm(), group.unit_length);
      first += count;
    }
    return x;
  }
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& x) const {
    return (x.rowwise() - mean_).array().rowwise() / deviation_.array();
  }

  recordings::Plan plan_;
  std::vector<int> places_;
  Eigen::RowVectorXd mean_, deviation_;
  recordings::Ridge ridge_;
};

double strongest(const SensorTrack& track, Eigen::Index row) {
  const Eigen::RowVectorXd counts = track.input.row(row).head(sensing::kElectrodeCount);
  Eigen::Index place = 0;
  counts.cwiseAbs().maxCoeff(&place);
  return counts[place];
}

/// The localisation as configured for the sensor of `tracks`.
sensing::LocalizationOptions localization_of(const std::vector<SensorTrack>& tracks) {
  sensing::LocalizationOptions options;
  options.polarity = polarity_of(tracks);
  std::vector<double> sizes;
  for (const SensorTrack& track : tracks)
    for (std::size_t k = 0; k < track.counts.size(); ++k)
      if (track.counts[k])
        sizes.push_back(std::abs(strongest(track, static_cast<Eigen::Index>(k))));
  if (sizes.empty()) return options;
  // Full intensity is the 99 % quantile over the presses.
  const auto place =
      sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), place, sizes.end());
  options.saturation = *place;
  return options;
}

/// Normals of the skin at the contact point given by the electrodes, n x 3, in T.
Eigen::MatrixXd located_normals(const SensorTrack& track, sensing::LocalizationOptions options,
                                sensing::ElectrodeScatter scatter) {
  options.polarity = polarity_of({track});
  math::Random random(1);
  Eigen::MatrixXd normals(track.input.rows(), 3);
  Eigen::Vector3d location(0, 0, -sensing::kSkinRadius);
  for (Eigen::Index k = 0; k < normals.rows(); ++k) {
    const sensing::ElectrodeVector counts =
        track.input.row(k).head(sensing::kElectrodeCount).transpose();
    const sensing::Localization found = sensing::locate_contact(
        counts, options, sensing::scatter_electrodes(counts, options, scatter, random));
    if (found.active > 0) location = found.location;
    normals.row(k) = sensing::skin_normal(location).transpose();
  }
  return normals;
}

void add_localization(const FingertipFrame& frame, std::vector<SensorMethod>& methods) {
  for (const auto& [weighting, weighting_name] :
       {std::pair{sensing::Weighting::kCentroid, "centroid"},
        std::pair{sensing::Weighting::kPublished, "published"}})
    for (const auto& [scatter, scatter_name] :
         {std::pair{sensing::ElectrodeScatter::kNominal, "nominal"},
          std::pair{sensing::ElectrodeScatter::kGaussian, "gaussian"},
          std::pair{sensing::ElectrodeScatter::kInvertedGaussian, "inverted gaussian"}}) {
      sensing::LocalizationOptions options = frame.localization;
      options.weighting = weighting;
      methods.push_back({std::string("localised: ") + weighting_name + ", " + scatter_name, false,
                         [options, scatter = scatter, R_NT = frame.R_NT](const SensorTrack& track) {
                           return Eigen::MatrixXd(located_normals(track, options, scatter) *
                                                  R_NT.transpose());
                         }});
    }
}

/// The part of a wrist's motion that is known without an inertial unit: gravity.
std::vector<sensing::MotionSample> at_rest(const SensorTrack& track) {
  const int gravity = sensing::observer_input_index("gravity_x");
  std::vector<sensing::MotionSample> samples = track.samples;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].motion = {};
    samples[k].motion.specific_force =
        -kSensorsBaselinesGravity *
        track.input.row(static_cast<Eigen::Index>(k)).segment<3>(gravity).transpose();
  }
  return samples;
}

Eigen::MatrixXd load_of(const sensing::PayloadParameters& payload,
                        const std::vector<sensing::MotionSample>& samples) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(samples.size()), 6);
  for (std::size_t k = 0; k < samples.size(); ++k)
    rows.row(static_cast<Eigen::Index>(k)) =
        sensing::load_wrench(payload, samples[k].motion).vector().transpose();
  return rows;
}

/// Payload and biases identified from the training rows.
recordings::DataSet identify(const SensorTraining& training, const std::vector<SensorTrack>& tracks,
                             bool moving) {
  recordings::DataPlan plan = plan_of(SensorKind::kWrist).data;
  plan.target = recordings::Target::kMeasured;
  recordings::DataSet data;
  std::vector<recordings::WristRecording> wrists;
  for (const SensorTrack& track : tracks) {
    recordings::Recording recording;
    recording.time = track.time;
    for (const bool learn : rows_to_learn(training, track))
      recording.parts.push_back(learn ? recordings::Part::kTraining : recordings::Part::kTest);
    recording.counts = track.counts;
    data.recordings.push_back(recording);
    wrists.push_back({track.time, moving ? track.samples : at_rest(track), track.input, {}});
  }
  recordings::finish_wrists(plan, wrists, data);
  return data;
}

std::vector<SensorMethod> wrist_baselines(const SensorTraining& training,
                                          const std::vector<SensorTrack>& known) {
  std::vector<SensorTrack> tracks;
  std::vector<Eigen::MatrixXd> inputs, outputs;
  for (const SensorTrack& track : known)
    if (training.find(track.recording) != nullptr) tracks.push_back(track);
  const recordings::DataSet moving = identify(training, tracks, true);
  const recordings::DataSet resting = identify(training, tracks, false);
  for (std::size_t r = 0; r < tracks.size(); ++r) {
    const std::vector<bool> rows = rows_to_learn(training, tracks[r]);
    inputs.push_back(wanted_rows(tracks[r].input, rows));
    outputs.push_back(wanted_rows(moving.recordings[r].outputs, rows));
  }
  const LinearMap ridge(SensorKind::kWrist, stacked(inputs), stacked(outputs));
  return {
      {"newton_euler, inertial unit", false,
       [payload = *moving.payload](const SensorTrack& t) { return load_of(payload, t.samples); }},
      {"newton_euler, gravity only", false,
       [payload = *resting.payload](const SensorTrack& t) { return load_of(payload, at_rest(t)); }},
      {"ridge", false, [ridge](const SensorTrack& t) { return ridge(t.input); }},
      {"tare only", false,
       [](const SensorTrack& t) { return Eigen::MatrixXd::Zero(t.truth.rows(), 6).eval(); }}};
}

}  // namespace

std::vector<SensorMethod> make_baselines(SensorKind kind, const SensorTraining& training,
                                         const std::vector<SensorTrack>& known) {
  std::vector<Eigen::MatrixXd> inputs, truths;
  for (const SensorTrack& track : known) {
    const std::vector<bool> rows = rows_to_learn(training, track);
    inputs.push_back(wanted_rows(track.input, rows));
    truths.push_back(wanted_rows(track.truth, rows));
  }
  const Eigen::MatrixXd input = stacked(inputs), truth = stacked(truths);
  if (truth.rows() < kFewestRows) return {};
  if (kind == SensorKind::kWrist) return wrist_baselines(training, known);

  std::vector<SensorMethod> methods;
  if (kind == SensorKind::kDirection) add_localization(*fit_frame(training, known), methods);
  const LinearMap ridge(kind, input, truth);
  methods.push_back({"ridge", false, [ridge](const SensorTrack& t) { return ridge(t.input); }});
  const Eigen::RowVectorXd mean = truth.colwise().mean();
  methods.push_back({"mean", false, [mean](const SensorTrack& t) {
                       return mean.replicate(t.truth.rows(), 1).eval();
                     }});
  return methods;
}

std::optional<FingertipFrame> fit_frame(const SensorTraining& training,
                                        const std::vector<SensorTrack>& known) {
  std::vector<SensorTrack> learned;
  for (const SensorTrack& track : known)
    if (training.find(track.recording) != nullptr) learned.push_back(track);
  FingertipFrame frame;
  frame.localization = localization_of(learned);
  std::vector<Eigen::MatrixXd> located, measured;
  for (const SensorTrack& track : learned) {
    const std::vector<bool> rows = rows_to_learn(training, track);
    located.push_back(wanted_rows(
        located_normals(track, frame.localization, sensing::ElectrodeScatter::kNominal), rows));
    measured.push_back(wanted_rows(track.truth, rows));
  }
  const Eigen::MatrixXd from = stacked(located);
  if (from.rows() < kFewestRows) return {};
  frame.R_NT = rotation_between(from.transpose(), stacked(measured).transpose());
  return frame;
}

double polarity_of(const std::vector<SensorTrack>& tracks) {
  double sum = 0;
  for (const SensorTrack& track : tracks)
    for (std::size_t k = 0; k < track.counts.size(); ++k)
      if (track.counts[k]) sum += strongest(track, static_cast<Eigen::Index>(k));
  return sum < 0 ? -1 : 1;
}

Eigen::Matrix3d rotation_between(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(to * from.transpose(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

}  // namespace palpate::sensor_models
