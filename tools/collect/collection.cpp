#include "tools/collect/collection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <palpate/biotac_t.hpp>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <sstream>
#include <stdexcept>

#include "rt/bus/session.hpp"
#include "sim/sensors/channel.hpp"
#include "tools/log/event_log.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::collect {
namespace {

using Eigen::Vector3d;

constexpr double kTick = 1e-3;  // s
constexpr double kMostLean =
    0.1;  // tangential fraction of the force: no probe stands exactly perpendicular

/// Any unit vector perpendicular to `normal`.
Vector3d across(const Vector3d& normal, math::Random& random) {
  Vector3d v(random.normal(), random.normal(), random.normal());
  v -= normal * normal.dot(v);
  return v.normalized();
}

sensors::BiotacTable varied(sensors::BiotacTable table, double deviation, math::Random& random) {
  const auto vary = [&](double& value) { value *= std::exp(deviation * random.normal()); };
  vary(table.skin.foundation);
  vary(table.skin.shear_stiffness);
  vary(table.skin.spread);
  vary(table.pressure_area);
  return table;
}

class CsvCollection : public CollectionFile {
 public:
  CsvCollection(const std::filesystem::path& path, bool resume) : path_(path.string()) {
    const bool goes_on = resume && std::filesystem::exists(path);
    if (goes_on) count_trials();
    file_.open(path_, goes_on ? std::ios::app : std::ios::trunc);
    if (!goes_on) {
      file_ << "trial,probe,area,profile,t,fx,fy,fz,tx,ty,tz,pac0,pac1,pdc,tac,tdc";
      for (int i = 1; i <= sensing::kElectrodeCount; ++i) file_ << ",e" << i;
      file_ << "\n";
    }
    if (!file_) throw std::runtime_error(path_ + ": cannot be written");
  }

  void add(const Trial& trial, const std::vector<Sample>& samples) override {
    std::ostringstream rows;
    rows << std::setprecision(9);
    for (const Sample& sample : samples) {
      rows << trial.number << ',' << trial.probe.name << ',' << trial.area << ','
           << trial.profile.name << ',' << 1e-6 * static_cast<double>(sample.time_us);
      for (const double w : sample.wrench) rows << ',' << w;
      const sensors::BiotacReading& b = sample.biotac;
      for (const int value : {b.pac[0], b.pac[sensors::kVibrationSamples / 2], b.pdc, b.tac, b.tdc})
        rows << ',' << value;
      for (const int e : b.electrodes) rows << ',' << e;
      rows << '\n';
    }
    file_ << rows.str() << std::flush;
    if (!file_) throw std::runtime_error(path_ + ": cannot be written");
    ++trials_;
  }

  int trials() const override { return trials_; }

 private:
  /// Truncates a trial that was being written when the program ended.
  void count_trials() {
    std::ifstream in(path_);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    const std::size_t end = text.rfind('\n');
    if (end == std::string::npos || end + 1 != text.size())
      throw std::runtime_error(path_ + ": ends within a row: cannot be resumed");
    recordings::CsvReader csv(path_);
    const int column = csv.column("trial");
    int rows = 0, first_rows = 0;
    while (csv.next()) {
      const int trial = static_cast<int>(csv.number(column));
      if (trial != trials_ - 1) {
        if (trial != trials_) csv.fail(column, "trials do not follow each other");
        if (trials_ == 1) first_rows = rows;
        ++trials_;
        rows = 0;
      }
      ++rows;
    }
    if (trials_ > 1 && rows != first_rows)
      throw std::runtime_error(path_ + ": its last trial is not whole: cannot be resumed");
  }

  std::string path_;
  std::ofstream file_;
  int trials_ = 0;
};

class LogCollection : public CollectionFile {
 public:
  explicit LogCollection(const std::filesystem::path& path) : log_(path) {}

  void add(const Trial& trial, const std::vector<Sample>& samples) override {
    component_event_t mark = log::trial_event(trial.number, name_of(trial));
    mark_stamp_.put(mark, start_us_);
    write(channel::kComponentEvent, mark);
    for (const Sample& sample : samples) {
      const std::int64_t utime = start_us_ + sample.time_us;
      ft_wrench_t wrench{};
      wrench_stamp_.put(wrench, utime);
      std::copy(sample.wrench.begin(), sample.wrench.end(), wrench.wrench);
      write(channel::kFtWrench, wrench);
      biotac_t touch{};
      biotac_stamp_.put(touch, utime);
      touch.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC |
                    biotac_t::VALID_TEMPERATURE;
      const sensors::BiotacReading& b = sample.biotac;
      std::copy(b.electrodes.begin(), b.electrodes.end(), touch.electrodes);
      std::copy(b.pac.begin(), b.pac.end(), touch.pac);
      touch.pac_count = sensors::kVibrationSamples;
      touch.pdc = b.pdc;
      touch.tac = b.tac;
      touch.tdc = b.tdc;
      write(channel::kBiotac0, touch);
    }
    start_us_ += static_cast<std::int64_t>(1e6 * (kTrialTime + kApart));
    ++trials_;
  }

  int trials() const override { return trials_; }

 private:
  static constexpr double kApart = 2;  // s

  template <class Message>
  void write(const char* channel, const Message& message) {
    log_.write(channel, message.utime, message);
  }

  log::EventLog log_;
  std::int64_t session_ = bus::random_session();
  bus::HeaderStamper mark_stamp_{session_}, wrench_stamp_{session_}, biotac_stamp_{session_};
  std::int64_t start_us_ = 1000000;
  int trials_ = 0;
};

}  // namespace

std::vector<Sample> Bench::run(const Trial& trial) const {
  const std::string name = "trial" + std::to_string(trial.number);
  math::Random random(seed_, name);
  const sensors::BiotacTable table = varied(table_.biotac, variety_.skin, random);
  const double period = 1 / table.timing.rate;
  sensors::Biotac biotac(table, period, random.split("biotac"));
  const auto& faults = table_.force_torque;
  sensors::Signal force(faults.force, period, faults.bias.head<3>(), random.split("force"));
  sensors::Signal torque(faults.torque, period, faults.bias.tail<3>(), random.split("torque"));

  const Vector3d centre = sensing::project_on_skin(sensing::area_centres().col(trial.area - 1));
  const Vector3d offset = variety_.place * Vector3d(random.normal(), random.normal(), 0);
  const Vector3d at = sensing::project_on_skin(centre + offset);
  const Vector3d normal = sensing::skin_normal(at);
  const Vector3d lean = random.uniform(0, kMostLean) * across(normal, random);
  const Vector3d shear_from = across(normal, random), shear_to = across(normal, random);
  const double phase = random.uniform(0, 2 * M_PI), pace = random.uniform(0.5, 1.5);  // Hz

  std::vector<Sample> samples;
  const auto ticks = std::lround(kTrialTime / kTick);
  const auto ticks_per_sample = std::lround(period / kTick);
  for (long tick = 1; tick <= ticks; ++tick) {
    const double t = static_cast<double>(tick) * kTick;
    const double part = (t - kRest) / (kApproach + kHold);
    const double pressing = trial.profile.force * envelope(t) *
                            (1 + trial.profile.wander * std::sin(2 * M_PI * pace * t + phase));
    const Vector3d sideways =
        lean + trial.profile.shear * ((1 - part) * shear_from + part * shear_to);
    sensors::Touch touch;
    touch.location_T = at;
    touch.force_T = pressing * (sideways - normal);
    touch.radius = contact_radius(trial.probe, pressing, table.skin.foundation);
    biotac.step(kTick, {touch});
    if (tick % ticks_per_sample != 0) continue;
    Sample sample;
    sample.time_us = std::lround(1e6 * t);
    sample.biotac = biotac.read();
    const Vector3d on_probe = -touch.force_T;
    sample.wrench << force.measure(on_probe), torque.measure(at.cross(on_probe));
    samples.push_back(sample);
  }
  return samples;
}

std::unique_ptr<CollectionFile> open_collection(const std::filesystem::path& path, bool resume) {
  if (path.extension() != ".log") return std::make_unique<CsvCollection>(path, resume);
  if (resume) throw std::invalid_argument("a log cannot be resumed; collect into a CSV");
  return std::make_unique<LogCollection>(path);
}

}  // namespace palpate::collect
