#include "tools/lab/sensor_models/observer.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "rt/inference/model_card.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/sensor_models/observer_recording.hpp"
#include "tools/lab/sensor_models/observer_score.hpp"

namespace palpate::sensor_models {
namespace {

namespace fs = std::filesystem;

constexpr double kStandardGravity = 9.81;  // m/s^2
constexpr double kResidualBar = 0.02;      // of the payload's weight
constexpr double kTrackingBar = 0.05;      // of the peak of the true force
constexpr double kSettled = 2;             // s, by when every model has tared
constexpr double kPatience = 1800;         // s, for a program
constexpr const char* kMotions[] = {"manual", "rotation_y", "rotation_z", "collision"};
constexpr const char* kModels[] = {"newton_euler", "newton_euler_smooth", "ft_rnnob", "thesis"};
constexpr double kSmooth = 16;  // Hz; the same delay as the mean over 20 ms of ft_rnnob
constexpr const char* kCollision = "collision";

bool is_learned(const std::string& model) { return model == "ft_rnnob" || model == "thesis"; }

template <std::size_t n>
std::vector<std::string> chosen(const std::vector<std::string>& names,
                                const char* const (&all)[n]) {
  return names.empty() ? std::vector<std::string>(std::begin(all), std::end(all)) : names;
}

struct Scored {
  std::string model, motion;
  ForceSeries felt;
  std::optional<ResidualScore> residual;
  std::optional<TrackingScore> tracking;
  bool passed(double weight) const {
    if (tracking) return tracking->error_max <= kTrackingBar * tracking->peak;
    return residual->force_max <= kResidualBar * weight;
  }
};

class Experiment {
 public:
  explicit Experiment(const ObserverOptions& options)
      : options_(options),
        motions_(chosen(options.motions, kMotions)),
        models_(chosen(options.models, kModels)),
        configuration_((options.root / "rt/config/examples/payload_arm.yaml").string()),
        steps_(static_cast<int>(2 + models_.size() + motions_.size() * models_.size())) {}

  int run(std::ostream& out) {
    record_training();
    record_tests();
    for (const std::string& model : models_)
      if (is_learned(model)) train(model);
    identify_payload();
    for (const std::string& motion : motions_)
      for (const std::string& model : models_) score(motion, model);
    report(out);
    write_files();
    for (const std::string& motion : motions_) plot(motion);
    return std::all_of(
               scored_.begin(), scored_.end(),
               [this](const Scored& s) { return s.model != "ft_rnnob" || s.passed(weight()); })
               ? 0
               : 1;
  }

 private:
  double weight() const { return kStandardGravity * payload_.mass; }
  fs::path scene(const std::string& motion) const {
    return options_.root / "sim/scenes" / ("payload_" + motion + ".yaml");
  }
  fs::path training() const { return options_.output / "training"; }
  fs::path model(const std::string& name) const {
    return options_.output / "models" / (name + ".pt");
  }

  /// The last recording of each kind of motion is used for validation. Each has its own motion and
  /// sensor errors.
  void record_training() {
    common::Progress progress(++step_, steps_, "recording motions to learn from");
    const auto frames = registry::read_frames(config::Node::load_file(configuration_));
    const double rate = config::Node::load_file(preset()).child("data").number("rate", {1, 1000});
    const int count = options_.recordings + 1;
    int done = 0;
    for (const char* motion : {"slow", "fast"}) {
      for (int i = 1; i <= count; ++i) {
        const std::string name = std::string(motion) + "_" + std::to_string(i);
        const int seed = 10 * i + (motion[0] == 's' ? 1 : 2);
        const fs::path csv = training() / (name + ".csv");
        if (!options_.keep || !fs::exists(csv)) {
          const MotionLogs logs = record_motion(
              scene(motion),
              {"seed=" + std::to_string(seed), "motion.wander.seed=" + std::to_string(seed)},
              options_.output / "logs", name, options_.longest);
          fs::create_directories(training());
          write_wrist_csv(logs.control, frames, rate, csv);
        }
        recordings_ += (done == 0 ? "{file: " : ", {file: ") + name + ".csv" +
                       (i == count ? ", validation: [0, 100000]}" : "}");
        progress.show(static_cast<double>(++done) / (2 * count));
      }
    }
    progress.finish(true);
  }

  void record_tests() {
    common::Progress progress(++step_, steps_, "recording motions to be scored on");
    for (const std::string& motion : motions_)
      logs_[motion] = record_motion(scene(motion), {"seed=1000"}, options_.output / "logs", motion,
                                    motion == kCollision ? 0 : options_.longest);
    progress.finish(true);
  }

  std::string preset() const {
    return (options_.root / "tools/train/presets/ft_rnnob_simulated.yaml").string();
  }

  void train(const std::string& name) {
    common::Progress progress(++step_, steps_, "training " + name);
    if (options_.keep && fs::exists(inference::card_path(model(name).string())))
      return progress.finish(true, "kept");
    fs::create_directories(model(name).parent_path());
    const bool ours = name == "ft_rnnob";
    std::vector<std::string> command{(common::program_folder() / "palpate-train").string(),
                                     ours ? preset() : "ft_rnnob_thesis",
                                     "--data",
                                     training().string(),
                                     "--output",
                                     model(name).string(),
                                     "--set",
                                     "data.recordings=[" + recordings_ + "]"};
    const auto set = [&command](const std::string& setting) {
      command.push_back("--set");
      command.push_back(setting);
    };
    if (!ours) {
      // The same streams at the same rate; network and outputs are those of the thesis.
      for (const char* setting :
           {"data.rate=200", "data.average=0.02", "data.wrist.acceleration_has_gravity=true",
            "data.wrist.largest_delay=0.05", "training.refit=false", "training.evaluate_every=50"})
        set(setting);
    }
    if (options_.iterations > 0) set("training.iterations=" + std::to_string(options_.iterations));
    run_program(command, model(name).replace_extension(".txt"));
    progress.finish(true);
  }

  /// From the training recordings: the payload identified by palpate-train.
  void identify_payload() {
    const std::string learned = model("ft_rnnob").replace_extension(".yaml").string();
    if (!fs::exists(learned))
      throw config::Error(
          "the payload is what the training of ft_rnnob finds: name it among the "
          "models, or keep one that was trained before");
    payload_ = *inference::read_card(learned).payload;
  }

  static void run_program(const std::vector<std::string>& command, const fs::path& output) {
    if (const int code = common::run_to_end(command, output, kPatience))
      throw runs::RunFailed(command.front() + " ended with exit code " + std::to_string(code) +
                            ":\n" + common::tail(output, 15));
  }

  std::vector<std::string> settings(const std::string& name) const {
    const auto list = [](const auto& values) {
      std::ostringstream text;
      text.precision(12);
      for (Eigen::Index i = 0; i < values.size(); ++i) text << (i == 0 ? "[" : ", ") << values(i);
      return text.str() + "]";
    };
    if (!is_learned(name)) {
      std::ostringstream mass;
      mass.precision(12);
      mass << payload_.mass;
      std::vector<std::string> settings{"sensing.0.payload={mass: " + mass.str() +
                                        ", center_of_mass: " + list(payload_.center_of_mass()) +
                                        ", inertia: " + list(payload_.inertia) + "}"};
      if (name == "newton_euler_smooth")
        settings.push_back("sensing.0.cutoff_hz=" + std::to_string(kSmooth));
      return settings;
    }
    return {"sensing=[{name: wrist, component: ft_rnnob, model_file: " +
            fs::absolute(model(name)).string() + ", executor: " + options_.executor +
            ", tare_samples: 200, tare_at_start: true}]"};
  }

  void score(const std::string& motion, const std::string& name) {
    common::Progress progress(++step_, steps_, motion + ", " + name);
    const fs::path log = options_.output / "logs" / (motion + "." + name + ".log");
    std::vector<std::string> command{(common::program_folder() / "palpate-replay").string(),
                                     logs_.at(motion).control.string(),
                                     "--config",
                                     configuration_,
                                     "--output",
                                     log.string(),
                                     "--start"};
    for (const std::string& setting : settings(name)) {
      command.push_back("--set");
      command.push_back(setting);
    }
    run_program(command, fs::path(log).replace_extension(".txt"));
    Scored scored{name, motion, read_wrist_contacts(log, kSettled), {}, {}};
    if (motion == kCollision) {
      if (truth_.time.empty()) truth_ = read_true_touch(logs_.at(motion).housekeeping);
      scored.tracking = score_tracking(scored.felt, truth_);
    } else {
      scored.residual = score_residual(scored.felt);
    }
    progress.finish(scored.passed(weight()));
    scored_.push_back(std::move(scored));
  }

  void report(std::ostream& out) const {
    out << "payload identified: " << common::number(payload_.mass, 4) << " kg, weight "
        << common::number(weight(), 2) << " N\n\n";
    common::Table residual({"without contact", "force RMS N", "max N", "RMS %", "max %",
                            "torque RMS N m", "max N m", "max within 2 %"});
    common::Table tracking({"collision", "peak N", "error RMS N", "max N", "RMS %", "max %",
                            "at peak %", "lag ms", "max % without lag", "max within 5 %"});
    std::string section;
    bool collided = false;
    for (const Scored& s : scored_) {
      const std::string verdict = s.passed(weight()) ? "yes" : "no";
      if (s.tracking) {
        const TrackingScore& t = *s.tracking;
        const double share = 100 / t.peak;
        tracking.add({s.model, common::number(t.peak, 2), common::number(t.error_rms, 3),
                      common::number(t.error_max, 3), common::number(share * t.error_rms, 2),
                      common::number(share * t.error_max, 2),
                      common::number(share * t.peak_error, 2), common::number(1e3 * t.lag, 0),
                      common::number(share * t.lagged_max, 2), verdict});
        collided = true;
        continue;
      }
      if (s.motion != section) residual.section(section = s.motion);
      const ResidualScore& r = *s.residual;
      const double share = 100 / weight();
      residual.add({s.model, common::number(r.force_rms, 3), common::number(r.force_max, 3),
                    common::number(share * r.force_rms, 2), common::number(share * r.force_max, 2),
                    common::number(r.torque_rms, 4), common::number(r.torque_max, 4), verdict});
    }
    residual.print(out);
    out << '\n';
    if (collided) tracking.print(out);
  }

  nlohmann::json to_json(const Scored& s) const {
    nlohmann::json json{{"model", s.model}, {"motion", s.motion}, {"passed", s.passed(weight())}};
    if (s.residual) {
      json["force_rms_n"] = s.residual->force_rms;
      json["force_max_n"] = s.residual->force_max;
      json["torque_rms_nm"] = s.residual->torque_rms;
      json["torque_max_nm"] = s.residual->torque_max;
      json["force_rms_share"] = s.residual->force_rms / weight();
      json["force_max_share"] = s.residual->force_max / weight();
    }
    if (s.tracking) {
      const TrackingScore& t = *s.tracking;
      json["peak_n"] = t.peak;
      json["error_rms_n"] = t.error_rms;
      json["error_max_n"] = t.error_max;
      json["peak_error_n"] = t.peak_error;
      json["lag_s"] = t.lag;
      json["error_rms_without_lag_n"] = t.lagged_rms;
      json["error_max_without_lag_n"] = t.lagged_max;
      json["error_max_share"] = t.error_max / t.peak;
    }
    return json;
  }

  void write_files() const {
    nlohmann::json json{{"payload_mass_kg", payload_.mass}, {"payload_weight_n", weight()},
                        {"executor", options_.executor},    {"residual_bar", kResidualBar},
                        {"tracking_bar", kTrackingBar},     {"runs", nlohmann::json::array()}};
    std::ofstream csv(options_.output / "observer.csv");
    csv << "motion,model,force_rms_n,force_max_n,torque_rms_nm,torque_max_nm,peak_n,error_rms_n,"
           "error_max_n,lag_s,error_max_without_lag_n,passed\n";
    for (const Scored& s : scored_) {
      json["runs"].push_back(to_json(s));
      csv << s.motion << ',' << s.model << ',';
      if (s.residual)
        csv << s.residual->force_rms << ',' << s.residual->force_max << ','
            << s.residual->torque_rms << ',' << s.residual->torque_max << ",,,,,,";
      else
        csv << ",,,," << s.tracking->peak << ',' << s.tracking->error_rms << ','
            << s.tracking->error_max << ',' << s.tracking->lag << ',' << s.tracking->lagged_max
            << ',';
      csv << (s.passed(weight()) ? 1 : 0) << '\n';
    }
    if (!csv) throw std::runtime_error("cannot write observer.csv in " + options_.output.string());
    common::write_json(json, options_.output / "observer.json");
    if (!options_.json.empty()) common::write_json(json, options_.json);
  }

  static common::Curve curve(const std::string& title, const ForceSeries& series,
                             const Eigen::RowVectorXd& values, bool dashed) {
    common::Curve curve;
    curve.title = title;
    curve.x = series.time;
    curve.y.assign(values.data(), values.data() + values.size());
    curve.dashed = dashed;
    return curve;
  }

  void plot(const std::string& motion) const {
    common::Plot force{motion + ": contact force", "time, s", "|F|, N", {}};
    common::Plot second{motion == kCollision ? "error of the contact force" : "contact torque",
                        "time, s",
                        motion == kCollision ? "|dF|, N" : "|T|, N m",
                        {}};
    if (motion == kCollision && !truth_.time.empty())
      force.curves.push_back(curve("truth", truth_, truth_.force.colwise().norm(), true));
    for (const Scored& s : scored_) {
      if (s.motion != motion) continue;
      force.curves.push_back(curve(s.model, s.felt, s.felt.force.colwise().norm(), false));
      if (motion == kCollision)
        second.curves.push_back(curve(s.model, truth_, tracking_error(s.felt, truth_), false));
      else
        second.curves.push_back(curve(s.model, s.felt, s.felt.torque.colwise().norm(), false));
    }
    common::try_draw({force, second}, options_.output / ("observer_" + motion + ".png"));
  }

  ObserverOptions options_;
  std::vector<std::string> motions_, models_;
  std::string configuration_;
  int steps_, step_ = 0;
  std::string recordings_;  // for palpate-train
  std::map<std::string, MotionLogs> logs_;
  sensing::PayloadParameters payload_;
  ForceSeries truth_;
  std::vector<Scored> scored_;
};

}  // namespace

int run_observer(const ObserverOptions& options, std::ostream& out) {
  fs::create_directories(options.output);
  return Experiment(options).run(out);
}

}  // namespace palpate::sensor_models
