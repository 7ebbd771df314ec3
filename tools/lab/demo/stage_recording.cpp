// Tactile shape sensing on a real recording, played in real time: a BioTac presses a foam bar that
// lies on a force-torque sensor.

#include <cmath>
#include <fstream>
#include <palpate/ft_wrench_t.hpp>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "tools/common/interruption.hpp"
#include "tools/lab/demo/demo.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/sensor_models/tactile.hpp"

namespace palpate::demo {
namespace {

constexpr const char* kRecording = "biotac_foam_bar/ring_finger_dev.csv";
constexpr const char* kStageRecordingConfiguration = "rt/config/examples/foam_bar_tactile.yaml";
constexpr std::int64_t kTare = 500000;  // us at the start without contact
constexpr double kForceBar = 0.03;      // N RMS, linear model fitted on the first half

/// Fits the sensor's force regression and writes it for palpated; the fit's output goes to a file.
std::filesystem::path fit_sensor(const Demo& demo, const std::filesystem::path& folder) {
  sensor_models::TactileOptions options;
  options.data = demo.options.data;
  options.model = folder / "tactile_model.yaml";
  std::ofstream report(folder / "tactile.txt");
  sensor_models::run_tactile(options, report);
  if (!std::filesystem::exists(options.model))
    throw runs::RunFailed("the sensor's model was not written to " + options.model.string());
  return options.model;
}

std::filesystem::path import_recording(const Demo& demo, const std::filesystem::path& folder) {
  const std::filesystem::path log = folder / "recording.log", output = folder / "import.txt";
  const int code = common::run_to_end({(common::program_folder() / "palpate-import").string(),
                                       (demo.options.data / kRecording).string(), "--preset",
                                       "biotac_foam_bar", "--output", log.string()},
                                      output, 60);
  if (code != 0) throw runs::RunFailed("palpate-import failed:\n" + common::tail(output, 10));
  return log;
}

/// Force of the recording's own sensor, N, tared, by time.
class TrueForce {
 public:
  explicit TrueForce(std::vector<ft_wrench_t> messages) : messages_(std::move(messages)) {
    if (messages_.empty()) throw runs::RunFailed("the log holds no FT_TRUTH");
    int count = 0;
    for (const ft_wrench_t& message : messages_) {
      if (message.utime > messages_.front().utime + kTare) break;
      rest_ += Eigen::Map<const Eigen::Vector3d>(message.wrench);
      ++count;
    }
    rest_ /= count;
  }
  const std::vector<ft_wrench_t>& messages() const { return messages_; }
  Eigen::Vector3d at(std::size_t i) const {
    return Eigen::Map<const Eigen::Vector3d>(messages_[i].wrench) - rest_;
  }

 private:
  std::vector<ft_wrench_t> messages_;
  Eigen::Vector3d rest_ = Eigen::Vector3d::Zero();
};

/// The daemon's contact in the first message after `utime`; the force is zero without contact.
struct FeltContact {
  Eigen::Vector3d force_T = Eigen::Vector3d::Zero();
  Eigen::Vector3d location = Eigen::Vector3d::Zero();
  bool touching = false;
};

FeltContact felt_at(const std::vector<contacts_t>& contacts, std::int64_t utime,
                    const Eigen::Matrix3d& R_OT) {
  const auto found = std::lower_bound(
      contacts.begin(), contacts.end(), utime,
      [](const contacts_t& message, std::int64_t time) { return message.utime < time; });
  FeltContact felt;
  if (found == contacts.end() || found->count < 1) return felt;
  felt.touching = true;
  felt.force_T = R_OT.transpose() * Eigen::Map<const Eigen::Vector3d>(found->wrench[0]);
  felt.location = Eigen::Map<const Eigen::Vector3d>(found->location[0]);
  return felt;
}

scores::RecordingScore score_recording(const log::RunLog& log, const TrueForce& truth,
                                       const Eigen::Matrix3d& R_OT) {
  // The daemon processes a sample within two cycles; one sample of the recording is 10 ms.
  constexpr std::int64_t kAnswer = 5000;  // us
  scores::RecordingScore score;
  double squares = 0, sizes = 0, truths = 0, most = 0;
  int count = 0;
  for (std::size_t i = truth.messages().size() / 2; i < truth.messages().size(); ++i) {
    const FeltContact felt = felt_at(log.contacts, truth.messages()[i].utime + kAnswer, R_OT);
    const Eigen::Vector3d force = truth.at(i);
    truths += force.squaredNorm();
    squares += (felt.force_T - force).squaredNorm();
    sizes += std::pow(felt.force_T.norm() - force.norm(), 2);
    ++count;
    if (!felt.touching) continue;
    score.duration += 0.01;
    if (felt.force_T.norm() > most) {
      most = felt.force_T.norm();
      score.location = felt.location;
    }
  }
  score.force_rms = std::sqrt(squares / count);
  score.force_magnitude_rms = std::sqrt(sizes / count);
  score.true_force_rms = std::sqrt(truths / count);
  return score;
}

double largest_displacement(const log::RunLog& log) {
  const log::MeshMessage mesh = log::assemble(log.shape_chunks);
  double largest = 0;
  for (const shape_t& shape : log.shapes)
    if (shape.node_count == mesh.nodes.cols())
      largest = std::max(largest, (log::positions(shape) - mesh.nodes).colwise().norm().maxCoeff());
  return largest;
}

void run_and_score(Demo& demo, scores::ScoredRun& scored) {
  common::Progress progress(++demo.begun, demo.runs, "real BioTac on a real foam bar");
  const std::filesystem::path folder = demo.log_folder("recording");
  std::filesystem::create_directories(folder);
  runs::RunPlan plan;
  plan.name = "recording";
  plan.configuration = demo.file(kStageRecordingConfiguration);
  plan.overrides = {"sensing.0.model_file=" + fit_sensor(demo, folder).string()};
  plan.source.log = import_recording(demo, folder);
  plan.duration = 60;  // the end of the recording comes first
  const runs::RunFiles files = runs::run_live(plan, folder, progress);

  const log::RunLog log = log::read_run(files.control, files.housekeeping);
  std::vector<ft_wrench_t> truth;
  log::LogReader reader;
  reader.collect("FT_TRUTH", truth);
  reader.read(files.control);
  const auto frames = registry::read_frames(config::Node::load_file(plan.configuration.string()));
  scored.loop = scores::score_loop(log);
  scored.recording = score_recording(log, TrueForce(std::move(truth)), frames.X_OT[0]->linear());
  scored.recording->largest_displacement = largest_displacement(log);
  if (scored.recording->force_rms > kForceBar)
    scored.missed.push_back("force error is above " + std::to_string(kForceBar) + " N RMS");
  progress.finish(scored.missed.empty());
}

}  // namespace

int count_recording(const Demo&) { return 1; }

void run_recording(Demo& demo) {
  scores::ScoredRun scored;
  scored.stage = "tactile sensing, real recording";
  scored.name = "biotac_foam_bar";
  const std::filesystem::path recording = demo.options.data / kRecording;
  if (!std::filesystem::exists(recording)) {
    common::Progress progress(++demo.begun, demo.runs, "real BioTac on a real foam bar");
    scored.skipped = recording.string() + " is absent; set PALPATE_DATA";
    progress.finish(true, "skipped: no recording");
  } else {
    try {
      run_and_score(demo, scored);
    } catch (const common::Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      scored.failure = error.what();
    }
  }
  demo.scored.push_back(scored);
}

}  // namespace palpate::demo
