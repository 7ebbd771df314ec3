#include "tools/lab/sensor_models/observer_recording.hpp"

#include <cmath>
#include <cstdio>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <stdexcept>

#include "sim/scenes/simulation.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::sensor_models {
namespace {

/// A separate bus for one URL, whose messages go to a log.
class Recorder {
 public:
  explicit Recorder(std::filesystem::path path)
      : path_(std::move(path)), bus_(bus::make_memory_bus(hub_)), log_(path_.string(), "w") {
    if (!log_.good()) throw std::runtime_error(path_.string() + ": cannot be written");
    bus::record(*hub_, &published_);
  }
  ~Recorder() { bus::record(*hub_, nullptr); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  bus::MessageBus& bus() { return *bus_; }
  const std::filesystem::path& path() const { return path_; }

  void write(std::int64_t utime) {
    for (bus::Published& message : published_) {
      lcm::LogEvent event{};
      event.timestamp = utime;
      event.channel = message.channel;
      event.datalen = static_cast<int>(message.data.size());
      event.data = message.data.data();
      if (log_.writeEvent(&event) != 0)
        throw std::runtime_error(path_.string() + ": cannot be written");
    }
    published_.clear();
  }

 private:
  std::filesystem::path path_;
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_;
  lcm::LogFile log_;
  std::vector<bus::Published> published_;
};

/// Messages of one stream in the order of their arrival; returns the latest at a time.
template <class Message>
class Arrivals {
 public:
  Arrivals(log::LogReader& log, std::string channel) : channel_(std::move(channel)) {
    log.collect(channel_, messages_);
  }
  void check() const {
    if (messages_.empty()) throw std::runtime_error("the log holds no " + channel_);
  }
  std::int64_t first() const { return messages_.front().utime; }
  std::int64_t last() const { return messages_.back().utime; }
  const Message& at(std::int64_t utime) {
    while (next_ + 1 < messages_.size() && messages_[next_ + 1].utime <= utime) ++next_;
    return messages_[next_];
  }

 private:
  std::string channel_;
  std::vector<Message> messages_;
  std::size_t next_ = 0;
};

using Vector3Map = Eigen::Map<const Eigen::Vector3d>;

void print(std::FILE* file, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double value : values) std::fprintf(file, ",%.9g", value);
}

}  // namespace

MotionLogs record_motion(const std::filesystem::path& scene,
                         const std::vector<std::string>& overrides,
                         const std::filesystem::path& folder, const std::string& name,
                         double longest) {
  std::filesystem::create_directories(folder);
  Recorder control(folder / (name + ".control.log"));
  Recorder housekeeping(folder / (name + ".housekeeping.log"));
  const auto node = config::Node::load_file(scene.string(), overrides);
  scenes::Simulation simulation(node, control.bus(), housekeeping.bus());
  const auto& motion = simulation.scene().motion;
  if (!motion) throw std::runtime_error(scene.string() + ": has no motion");
  const double end = longest > 0 ? std::min(longest, motion->duration()) : motion->duration();
  while (simulation.time() < end) {
    simulation.step();
    control.write(simulation.utime());
    housekeeping.write(simulation.utime());
  }
  return {control.path(), housekeeping.path()};
}

void write_wrist_csv(const std::filesystem::path& control_log, const registry::Frames& frames,
                     double rate, const std::filesystem::path& csv) {
  constexpr std::int64_t kPeriodUs = 1000;
  log::LogReader log;
  Arrivals<robot_state_t> robot(log, channel::kRobotState);
  Arrivals<imu_t> inertial(log, channel::kImu);
  Arrivals<ft_wrench_t> wrench(log, channel::kFtWrench);
  log.read(control_log);
  robot.check();
  inertial.check();
  wrench.check();
  const std::int64_t begin = std::max({robot.first(), inertial.first(), wrench.first()});
  const std::int64_t end = std::min({robot.last(), inertial.last(), wrench.last()});

  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(csv.c_str(), "w"),
                                                             &std::fclose);
  if (!file) throw std::runtime_error(csv.string() + ": cannot be written");
  std::fputs(
      "t_s,px,py,pz,qw,qx,qy,qz,vx,vy,vz,gyr_x,gyr_y,gyr_z,acc_x,acc_y,acc_z,fx,fy,fz,tx,ty,tz\n",
      file.get());
  const math::Pose X_SI = frames.X_ES.inverse() * frames.X_EI;
  const Eigen::Vector3d offset = -X_SI.translation();  // from I to S
  const auto step = static_cast<std::size_t>(std::lround(1e6 / (rate * kPeriodUs)));
  std::deque<Eigen::Vector3d> turns;  // angular velocities in S over the model's last step
  for (std::int64_t utime = begin; utime <= end; utime += kPeriodUs) {
    const robot_state_t& state = robot.at(utime);
    const Eigen::Matrix3d R_WE = math::rotation_from_wxyz(state.quaternion);
    double wxyz[4];
    math::wxyz_from_rotation(R_WE * frames.X_ES.linear(), wxyz);
    const Eigen::Vector3d velocity =
        Vector3Map(state.twist) +
        Vector3Map(state.twist + 3).cross(R_WE * frames.X_ES.translation());

    const imu_t& motion = inertial.at(utime);
    const Eigen::Vector3d turn = X_SI.linear() * Vector3Map(motion.angular_velocity);
    turns.push_back(turn);
    if (turns.size() > step + 1) turns.pop_front();
    const Eigen::Vector3d change = rate * (turn - turns.front());
    const Eigen::Vector3d force = X_SI.linear() * Vector3Map(motion.acceleration) +
                                  change.cross(offset) + turn.cross(turn.cross(offset));

    std::fprintf(file.get(), "%.3f", 1e-6 * static_cast<double>(utime - begin));
    print(file.get(), Vector3Map(state.position) + R_WE * frames.X_ES.translation());
    print(file.get(), Eigen::Map<const Eigen::Vector4d>(wxyz));
    print(file.get(), velocity);
    print(file.get(), turn);
    print(file.get(), force);
    print(file.get(), Eigen::Map<const math::Vector6d>(wrench.at(utime).wrench));
    std::fputc('\n', file.get());
  }
  if (std::ferror(file.get()) != 0) throw std::runtime_error(csv.string() + ": cannot be written");
}

}  // namespace palpate::sensor_models
