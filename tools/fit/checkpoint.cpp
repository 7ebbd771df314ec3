#include "tools/fit/checkpoint.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace palpate::fit {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, std::string hash, bool resumes)
    : path_(std::move(path)), hash_(std::move(hash)) {
  if (!resumes || path_.empty() || !std::filesystem::exists(path_)) return;
  try {
    std::ifstream in(path_);
    const nlohmann::json all = nlohmann::json::parse(in);
    if (all.at("plan") != hash_)
      throw std::runtime_error("belongs to another plan; remove it, or leave out --resume");
    for (const auto& [fit, entry] : all.at("fits").items())
      best_[fit] = {entry.at("cost"), entry.at("values"), true};
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(path_.string() + ": is damaged: " + error.what());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path_.string() + ": " + error.what());
  }
}

Eigen::VectorXd Checkpoint::start(const std::string& fit, const Problem& problem) const {
  Eigen::VectorXd x = problem.start();
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = best_.find(fit);
  if (found == best_.end()) return x;
  for (std::size_t i = 0; i < problem.free().size(); ++i) {
    const int parameter = problem.free()[i];
    const Parameter& p = problem.parameters()[parameter];
    const auto value = found->second.values.find(p.name);
    if (value != found->second.values.end())
      x[i] = problem.to_coordinate(parameter, std::clamp(value->second, p.lower, p.upper));
  }
  return x;
}

void Checkpoint::keep(const std::string& fit, const Problem& problem,
                      const Eigen::VectorXd& coordinates, double cost, bool is_last) {
  if (path_.empty()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = best_.find(fit);
  const bool is_better =
      found == best_.end() || found->second.is_old || is_last || cost < found->second.cost;
  if (is_better) {
    Best best{cost, {}, false};
    const Eigen::VectorXd values = problem.values(coordinates);
    for (const int i : problem.free()) best.values[problem.parameters()[i].name] = values[i];
    best_[fit] = std::move(best);
  }
  if (is_last || (is_better && seconds_now() - last_written_ > 1)) write();
}

void Checkpoint::write() {
  nlohmann::json all;
  all["plan"] = hash_;
  for (const auto& [fit, best] : best_)
    all["fits"][fit] = {{"cost", best.cost}, {"values", best.values}};
  const std::filesystem::path temporary = path_.string() + ".new";
  {
    std::ofstream out(temporary);
    out << all.dump(1) << '\n';
    if (!out.flush()) throw std::runtime_error("cannot write " + temporary.string());
  }
  std::filesystem::rename(temporary, path_);
  last_written_ = seconds_now();
}

void Checkpoint::remove() const {
  if (!path_.empty()) std::filesystem::remove(path_);
}

}  // namespace palpate::fit
