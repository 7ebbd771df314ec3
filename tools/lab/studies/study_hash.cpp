#include "tools/lab/studies/study_hash.hpp"

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "tools/common/process.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;

class Fnv {
 public:
  void add(const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      hash_ = (hash_ ^ static_cast<unsigned char>(bytes[i])) * 1099511628211ULL;
  }
  /// With its length, so that adjacent fields are unambiguous.
  void add(const std::string& text) {
    const std::string length = std::to_string(text.size()) + ":";
    add(length.data(), length.size());
    add(text.data(), text.size());
  }
  void add(double value) { add(reinterpret_cast<const char*>(&value), sizeof value); }
  std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_));
    return digits;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

/// Bytes of every file that a scalar of the document names, relative to the document's folder.
void add_named_files(Fnv& hash, const YAML::Node& node, const fs::path& folder) {
  if (node.IsScalar() && !node.Scalar().empty()) {
    std::error_code none;
    const fs::path file = folder / node.Scalar();
    if (fs::is_regular_file(file, none)) hash.add(hash_of_file(file));
  }
  if (node.IsSequence())
    for (const auto& item : node) add_named_files(hash, item, folder);
  if (node.IsMap())
    for (const auto& entry : node) add_named_files(hash, entry.second, folder);
}

void add_document(Fnv& hash, const fs::path& file, const std::vector<std::string>& overrides) {
  hash.add(std::to_string(config::Node::load_file(file.string(), overrides).hash()));
  const fs::path folder = file.parent_path();
  add_named_files(hash, YAML::LoadFile(file.string()), folder);
  for (const std::string& setting : overrides)
    add_named_files(hash, YAML::Load(setting.substr(setting.find('=') + 1)), folder);
}

}  // namespace

std::vector<fs::path> study_programs() {
  const fs::path folder = common::program_folder();
  return {folder / "palpated", folder / "palpate-sim", folder / "palpate-evaluate"};
}

std::string hash_of_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  Fnv hash;
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0)
    hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
  return hash.text();
}

std::string hash_of_inputs(const StudyJob& job, const std::vector<std::string>& programs) {
  Fnv hash;
  for (const std::string& program : programs) hash.add(program);
  add_document(hash, job.scene, job.scene_overrides);
  add_document(hash, job.configuration, job.daemon_overrides);
  hash.add(job.kind);
  hash.add(std::to_string(job.seed) + (job.real_time ? " in real time" : " in lock-step"));
  hash.add(job.duration);
  hash.add(job.octree_resolution);
  for (const StudyState& state : job.states) {
    hash.add(state.name);
    hash.add(state.time);
  }
  for (const Eigen::Vector3d& point : job.pose_points)
    for (const double coordinate : point) hash.add(coordinate);
  if (job.target)
    for (const double value : job.target->values) hash.add(value);
  if (job.target && job.target->hand) {
    for (const double value : job.target->hand->translation) hash.add(value);
    for (const double value : job.target->hand->rotation_deg) hash.add(value);
  }
  return hash.text();
}

}  // namespace palpate::studies
