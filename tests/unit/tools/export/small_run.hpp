#pragma once

#include <cmath>
#include <palpate/contacts_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/export/log_writer.hpp"
#include "tests/unit/tools/export/two_shapes.hpp"
#include "tools/export/source.hpp"

namespace palpate::exporting {

/// Logs of the two URLs of a short synthetic run of one second: a bar of 0.2 m along x that is
/// stretched over time by up to 10 %, its estimate 1 mm off the truth along z.
class SmallRun {
 public:
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
  static constexpr int kShapes = 21;                             // one every 50 ms

  SmallRun() {
    LogWriter fast(control()), slow(housekeeping());
    for (int i = 0; i < 100; ++i) {
      const std::int64_t time = kStart + 10'000 * i;
      ft_wrench_t wrench{};
      head(wrench, time, i);
      for (int k = 0; k < 6; ++k) wrench.wrench[k] = 0.5 * i + k;
      fast.write("FT_WRENCH", time, wrench);
      if (i % 5 != 0) continue;
      fast.write("CONTACTS", time, contacts(time, i / 5));
      estimate_t estimate{};
      head(estimate, time, i / 5);
      estimate.grasp_count = 1;
      estimate.grasp_position[0][0] = 0.2;
      estimate.grasp_quaternion[0][0] = 1;
      estimate.reaction[0][0] = 2;
      estimate.log_young_modulus = std::log(30e3);
      estimate.poisson_ratio = 0.3;
      fast.write("ESTIMATE", time, estimate);
      robot_state_t robot{};
      head(robot, time, i / 5);
      robot.joint_count = 7;
      robot.quaternion[0] = 1;
      robot.position[2] = 0.5;
      fast.write("ROBOT_STATE", time, robot);
    }
    shape_mesh_t estimate_chunk = mesh_message(estimate_mesh),
                 truth_chunk = mesh_message(truth_mesh);
    head(estimate_chunk, kStart, 0);
    head(truth_chunk, kStart, 0);
    slow.write("SHAPE_MESH", kStart, estimate_chunk);
    slow.write("TRUTH_MESH", kStart, truth_chunk);
    for (int i = 0; i < kShapes; ++i) {
      // The truth is sampled 10 ms before and after the estimate, which lies between the two.
      const std::int64_t time = kStart + 50'000 * i;
      for (const int offset : {-10'000, 10'000})
        if (offset < 0)
          slow.write("TRUTH_SHAPE", time + offset, truth(time + offset, 2 * i));
        else
          slow.write("SHAPE", time, estimate(time, i)),
              slow.write("TRUTH_SHAPE", time + offset, truth(time + offset, 2 * i + 1));
    }
  }

  std::filesystem::path control() const { return folder_.path() / "control.log"; }
  std::filesystem::path housekeeping() const { return folder_.path() / "housekeeping.log"; }
  std::filesystem::path folder() const { return folder_.path(); }

  /// Of the bar, at a time in us.
  static double stretch(std::int64_t time) {
    return 1 + 0.1 * 1e-6 * static_cast<double>(time - kStart);
  }

  const log::MeshMessage estimate_mesh = tetrahedral_box({0.2, 0.04, 0.04}, {5, 1, 1});
  const log::MeshMessage truth_mesh = hexahedral_box({0.2, 0.04, 0.04}, {4, 1, 1});

 private:
  template <class Message>
  static void head(Message& message, std::int64_t time, int seq) {
    message.utime = time - 1000;  // sent one millisecond before it was received
    message.seq = seq;
    message.session = 5;
  }

  static contacts_t contacts(std::int64_t time, int seq) {
    contacts_t message{};
    head(message, time, seq);
    message.count = 1;
    message.location[0][0] = 0.2;
    message.location[0][1] = message.location[0][2] = 0.02;
    message.wrench[0][0] = 2;
    message.wrench[0][5] = 0.125;
    return message;
  }

  shape_t truth(std::int64_t time, int seq) const {
    Eigen::Matrix3Xd x = truth_mesh.nodes;
    x.row(0) *= stretch(time);
    shape_t message = shape_message(truth_mesh, x, time);
    head(message, time, seq);
    return message;
  }

  shape_t estimate(std::int64_t time, int seq) const {
    Eigen::Matrix3Xd x = estimate_mesh.nodes;
    x.row(0) *= stretch(time);
    x.row(2).array() += 1e-3;
    shape_t message = shape_message(estimate_mesh, x, time);
    head(message, time, seq);
    return message;
  }

  support::ScratchFolder folder_;
};

/// Options of a source without output on standard error.
inline SourceOptions quiet(const std::vector<std::filesystem::path>& logs) {
  SourceOptions options;
  options.logs = logs;
  options.quiet = true;
  return options;
}

}  // namespace palpate::exporting
