#include "tools/collect/collection.hpp"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <sstream>
#include <stdexcept>

#include "rt/bus/session.hpp"
#include "tools/log/event_log.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::collect {
namespace {

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
    write("COMPONENT_EVENT", mark);
    for (const Sample& sample : samples) {
      const std::int64_t utime = start_us_ + sample.time_us;
      ft_wrench_t wrench{};
      wrench_stamp_.put(wrench, utime);
      std::copy(sample.wrench.begin(), sample.wrench.end(), wrench.wrench);
      write("FT_WRENCH", wrench);
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
      write("BIOTAC_0", touch);
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

std::unique_ptr<CollectionFile> open_collection(const std::filesystem::path& path, bool resume) {
  if (path.extension() != ".log") return std::make_unique<CsvCollection>(path, resume);
  if (resume) throw std::invalid_argument("a log cannot be resumed; collect into a CSV");
  return std::make_unique<LogCollection>(path);
}

}  // namespace palpate::collect
