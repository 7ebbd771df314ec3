#include "tools/lab/sensor_models/tactile.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::sensor_models {
namespace {

using recordings::CsvReader;
using sensing::kElectrodeCount;
using sensing::kTactileInputCount;

using math::kDegree;
constexpr double kForceBar = 0.03;          // N
constexpr double kAngleBar = 10 * kDegree;  // rad
constexpr int kRestRows = 50;               // half a second at 100 Hz

double quantile(std::vector<double> values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double rms_norm(const Eigen::MatrixXd& rows) {
  return std::sqrt(rows.squaredNorm() / static_cast<double>(rows.rows()));
}

sensing::ElectrodeVector electrodes(const CsvReader& csv, int first_column) {
  sensing::ElectrodeVector counts;
  for (int i = 0; i < kElectrodeCount; ++i) counts[i] = csv.number(first_column + i);
  return counts;
}

/// e1 to e19 are adjacent columns.
int first_electrode(const CsvReader& csv) {
  const int first = csv.column("e1");
  if (csv.column("e19") != first + kElectrodeCount - 1)
    throw recordings::CsvError("columns e1 to e19 must stand side by side");
  return first;
}

/// Rows in contact: tared counts and normal in T.
struct Contacts {
  std::vector<sensing::ElectrodeVector> counts;
  std::vector<Eigen::Vector3d> normals;
};

Contacts read_contacts(const std::filesystem::path& file) {
  constexpr double kContactPdc = 25;
  CsvReader csv(file.string());
  const int log = csv.column("log"), pdc = csv.column("pdc"), nx = csv.column("nx");
  const int e1 = first_electrode(csv);
  struct Rest {
    int rows = 0;
    double pdc = 0;
    sensing::ElectrodeVector counts = sensing::ElectrodeVector::Zero();
  };
  std::map<std::string, Rest> rests;
  Contacts contacts;
  while (csv.next()) {
    Rest& rest = rests[csv.text(log)];
    const sensing::ElectrodeVector counts = electrodes(csv, e1);
    if (rest.rows < kRestRows) {
      ++rest.rows;
      rest.pdc += (csv.number(pdc) - rest.pdc) / rest.rows;
      rest.counts += (counts - rest.counts) / rest.rows;
      continue;
    }
    if (csv.number(pdc) < rest.pdc + kContactPdc) continue;
    contacts.counts.push_back(counts - rest.counts);
    // The data set's frame is T rotated by 180 degrees about y: its z points into the skin's side.
    contacts.normals.emplace_back(-csv.number(nx), csv.number(nx + 1), -csv.number(nx + 2));
  }
  if (contacts.counts.size() < 4)
    throw recordings::CsvError(file.string() + ": hardly any contact");
  return contacts;
}

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

const char* name_of(sensing::Weighting weighting) {
  return weighting == sensing::Weighting::kPublished ? "published" : "centroid";
}

bool print_force(const TactileForceScore& score, std::ostream& out) {
  const bool met = score.test_rms_norm <= kForceBar;
  common::Table table(
      {"biotac_foam_bar, force error N", "rows", "x", "y", "z", "|F|", "largest |F| N"});
  const auto row = [&](const std::string& name, int rows, const Eigen::Vector3d& rms,
                       double largest) {
    table.add({name, std::to_string(rows), common::number(rms.x(), 4), common::number(rms.y(), 4),
               common::number(rms.z(), 4), common::number(rms.norm(), 4),
               largest > 0 ? common::number(largest, 2) : ""});
  };
  row("first half, fitted", score.training_rows, score.fit.training_rms, score.largest_training);
  row("first half, blocks left out", score.training_rows, score.fit.cross_validated_rms, 0);
  row("second half, never seen", score.test_rows, score.test_rms, score.largest_test);
  table.print(out);
  out << "penalty " << score.fit.penalty
      << "; always the mean: " << common::number(score.mean_rms_norm, 3) << " N; bar "
      << common::number(kForceBar, 2) << " N: " << (met ? "met" : "MISSED") << "\n";
  return met;
}

bool print_localization(const std::vector<LocalizationScore>& scores, std::ostream& out) {
  common::Table table({"biotac_normal_dir, contact normal", "rows", "median deg", "90 % deg",
                       "mean normal deg", "bar deg", ""});
  bool met = true;
  for (const LocalizationScore& score : scores) {
    const bool judged = score.options.weighting == sensing::Weighting::kCentroid;
    const bool good = score.median <= kAngleBar;
    met = met && (good || !judged);
    table.add({name_of(score.options.weighting), std::to_string(score.contacts),
               common::number(score.median / kDegree, 1),
               common::number(score.ninetieth / kDegree, 1),
               common::number(score.mean_direction / kDegree, 1),
               judged ? common::number(kAngleBar / kDegree, 0) : "",
               judged ? (good ? "met" : "MISSED") : ""});
  }
  table.print(out);
  return met;
}

nlohmann::json to_json(const TactileForceScore& score) {
  const auto list = [](const Eigen::Vector3d& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  return {{"training_rows", score.training_rows},
          {"test_rows", score.test_rows},
          {"penalty", score.fit.penalty},
          {"training_rms", list(score.fit.training_rms)},
          {"cross_validated_rms", list(score.fit.cross_validated_rms)},
          {"test_rms", list(score.test_rms)},
          {"test_rms_norm", score.test_rms_norm},
          {"mean_rms_norm", score.mean_rms_norm},
          {"largest_training_force", score.largest_training},
          {"largest_test_force", score.largest_test},
          {"bar", kForceBar},
          {"met", score.test_rms_norm <= kForceBar}};
}

nlohmann::json to_json(const LocalizationScore& score) {
  return {{"weighting", name_of(score.options.weighting)},
          {"polarity", score.options.polarity},
          {"threshold", score.options.threshold},
          {"saturation", score.options.saturation},
          {"contacts", score.contacts},
          {"median", score.median},
          {"ninetieth", score.ninetieth},
          {"mean_direction", score.mean_direction}};
}

}  // namespace

TactileForceScore score_tactile_force(const std::filesystem::path& file) {
  CsvReader csv(file.string());
  const int fx = csv.column("fx"), pac = csv.column("pac0"), pdc = csv.column("pdc");
  const int e1 = first_electrode(csv);
  std::vector<sensing::TactileInputs> inputs;
  std::vector<Eigen::Vector3d> forces;
  while (csv.next()) {
    sensing::TactileInputs row;
    row << electrodes(csv, e1), csv.number(pac), csv.number(pdc);
    inputs.push_back(row);
    forces.emplace_back(csv.number(fx), csv.number(fx + 1), csv.number(fx + 2));
  }
  const auto rows = static_cast<Eigen::Index>(inputs.size());
  if (rows < 4 * kRestRows) throw recordings::CsvError(file.string() + ": too few rows");
  Eigen::MatrixXd X(rows, kTactileInputCount), Y(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    X.row(i) = inputs[i].transpose();
    Y.row(i) = forces[i].transpose();
  }
  const Eigen::RowVectorXd rest_counts = X.topRows(kRestRows).colwise().mean();
  const Eigen::RowVectorXd rest_force = Y.topRows(kRestRows).colwise().mean();
  X.rowwise() -= rest_counts;
  Y.rowwise() -= rest_force;

  const Eigen::Index half = rows / 2, rest = rows - half;
  TactileForceScore score;
  score.training_rows = static_cast<int>(half);
  score.test_rows = static_cast<int>(rest);
  score.fit = sensing::fit_linear_tactile(X.topRows(half), Y.topRows(half));
  const Eigen::MatrixXd error =
      ((X.bottomRows(rest) * score.fit.model.matrix.transpose()).rowwise() +
       score.fit.model.offset.transpose()) -
      Y.bottomRows(rest);
  score.test_rms =
      (error.colwise().squaredNorm().transpose() / static_cast<double>(rest)).cwiseSqrt();
  score.test_rms_norm = rms_norm(error);
  const Eigen::RowVectorXd mean = Y.topRows(half).colwise().mean();
  score.mean_rms_norm = rms_norm(Y.bottomRows(rest).rowwise() - mean);
  score.largest_training = Y.topRows(half).rowwise().norm().maxCoeff();
  score.largest_test = Y.bottomRows(rest).rowwise().norm().maxCoeff();
  return score;
}

sensing::LocalizationOptions normal_dir_localization(sensing::Weighting weighting) {
  sensing::LocalizationOptions options;
  options.polarity = -1;
  options.threshold = 5;
  options.saturation = 1000;
  options.weighting = weighting;
  return options;
}

LocalizationScore score_localization(const std::filesystem::path& file,
                                     const sensing::LocalizationOptions& options) {
  const Contacts contacts = read_contacts(file);
  const std::size_t half = contacts.counts.size() / 2;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < half; ++i) mean += contacts.normals[i];

  LocalizationScore score;
  score.options = options;
  std::vector<double> angles, mean_angles;
  for (std::size_t i = half; i < contacts.counts.size(); ++i) {
    const sensing::Localization found = sensing::locate_contact(contacts.counts[i], options);
    // No active electrode is a valid result as well: the centre of the pad.
    const Eigen::Vector3d place = found.active > 0 ? found.location : Eigen::Vector3d::Zero();
    angles.push_back(angle(sensing::skin_normal(place), contacts.normals[i]));
    mean_angles.push_back(angle(mean, contacts.normals[i]));
  }
  score.contacts = static_cast<int>(angles.size());
  score.median = quantile(angles, 0.5);
  score.ninetieth = quantile(angles, 0.9);
  score.mean_direction = quantile(mean_angles, 0.5);
  return score;
}

void write_tactile_yaml(const sensing::LinearTactileModel& model, std::ostream& out) {
  const bool products = model.features == sensing::TactileFeatures::kProducts;
  out.precision(9);
  out << "# Force of a fingertip: N = force * (features of the tared counts of e1 to e19, pac, "
         "pdc) + "
         "offset.\nmodel:\n  features: "
      << (products ? "products" : "counts") << '\n';
  const auto rows = [&out](const std::string& name,
                           const sensing::LinearTactileModel::Matrix& matrix) {
    for (int r = 0; r < 3; ++r) {
      out << "  " << name << '_' << "xyz"[r] << ": [";
      for (Eigen::Index c = 0; c < matrix.cols(); ++c)
        out << (c == 0 ? "" : c % 10 == 0 ? ",\n    " : ", ") << matrix(r, c);
      out << "]\n";
    }
  };
  rows("force", model.matrix);
  if (model.place.size() > 0) rows("place", model.place);
  out << "  offset: [" << model.offset.x() << ", " << model.offset.y() << ", " << model.offset.z()
      << "]\n";
}

int run_tactile(const TactileOptions& options, std::ostream& out) {
  const std::filesystem::path force_file = options.data / "biotac_foam_bar/ring_finger_dev.csv";
  const std::filesystem::path normal_file =
      options.data / "biotac_normal_dir/trial1_plate_contact.csv.gz";
  if (!std::filesystem::exists(force_file) &&
      (!options.model.empty() || !std::filesystem::exists(normal_file)))
    throw std::runtime_error("no recording was found: there is no " + force_file.string());
  bool met = true;
  nlohmann::json json;
  if (std::filesystem::exists(force_file)) {
    const TactileForceScore score = score_tactile_force(force_file);
    met = print_force(score, out) && met;
    json["force"] = to_json(score);
    if (!options.model.empty()) {
      std::ofstream file(options.model);
      if (!file) throw std::runtime_error(options.model.string() + ": cannot be written");
      write_tactile_yaml(score.fit.model, file);
    }
  } else {
    out << "biotac_foam_bar: absent below " << options.data.string() << "\n";
  }
  if (std::filesystem::exists(normal_file)) {
    std::vector<LocalizationScore> scores;
    for (const sensing::Weighting weighting :
         {sensing::Weighting::kPublished, sensing::Weighting::kCentroid})
      scores.push_back(score_localization(normal_file, normal_dir_localization(weighting)));
    met = print_localization(scores, out) && met;
    for (const LocalizationScore& score : scores) json["localization"].push_back(to_json(score));
  } else {
    out << "biotac_normal_dir: absent below " << options.data.string() << "\n";
  }
  if (!options.json.empty()) common::write_json(json, options.json);
  return met ? 0 : 1;
}

}  // namespace palpate::sensor_models
