#include "core/elasticity/contact/cone_problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/math/random.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Nodes coupled by a random positive definite matrix, each of them a sample.
struct Springs {
  Springs(int nodes, int seed) : samples(nodes), table(samples_of(nodes), nodes, nodes) {
    math::Random random(seed);
    MatrixXd B(3 * nodes, 3 * nodes);
    for (double& entry : B.reshaped()) entry = random.normal();
    const MatrixXd A = 100 * (B * B.transpose() / nodes + MatrixXd::Identity(3 * nodes, 3 * nodes));
    compliance = A.inverse();
    Eigen::VectorXf b(3 * nodes);
    for (int k = 0; k < nodes; ++k) {
      table.add(k, k, b, [&](Eigen::VectorXf& force) {
        force = (compliance * force.cast<double>()).cast<float>();
      });
    }
  }
  const std::vector<mesh::PointWeights>& samples_of(int nodes) {
    for (int k = 0; k < nodes; ++k) {
      samples[k].count = 1;
      samples[k].nodes[0] = k;
      samples[k].weights[0] = 1;
    }
    return samples;
  }

  std::vector<mesh::PointWeights> samples;
  ComplianceColumns table;
  MatrixXd compliance;
};

std::vector<ConePoint> random_points(int count, double friction, math::Random& random) {
  std::vector<ConePoint> points(count);
  for (int k = 0; k < count; ++k) {
    points[k].place = k;
    points[k].friction = friction;
    points[k].normal = Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    points[k].offset = 1e-3 * Vector3d(random.normal(), random.normal(), random.normal());
  }
  return points;
}

/// Gap and slip under the forces that have been found.
std::vector<Vector3d> errors(const Springs& springs, const std::vector<ConePoint>& points) {
  VectorXd force(3 * points.size());
  for (std::size_t k = 0; k < points.size(); ++k) force.segment<3>(3 * k) = points[k].force;
  const VectorXd u = springs.compliance * force;
  std::vector<Vector3d> all;
  for (std::size_t k = 0; k < points.size(); ++k)
    all.push_back(points[k].offset + u.segment<3>(3 * k));
  return all;
}

class Friction : public ::testing::TestWithParam<double> {};

TEST_P(Friction, TheLawsOfSignoriniAndCoulombHoldAtEveryPoint) {
  const double mu = GetParam();
  int sticking = 0, slipping = 0, open = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    const int count = 12;
    const Springs springs(count, seed);
    math::Random random(100 + seed);
    std::vector<ConePoint> points = random_points(count, mu, random);
    ConeProblem problem(count);
    EXPECT_LT(problem.solve(springs.table, {500, 1e-10}, points), 500);
    const std::vector<Vector3d> all = errors(springs, points);
    for (int k = 0; k < count; ++k) {
      const ConePoint& point = points[k];
      const double r_n = point.normal.dot(point.force), e_n = point.normal.dot(all[k]);
      const Vector3d r_t = point.force - r_n * point.normal, e_t = all[k] - e_n * point.normal;
      EXPECT_GE(r_n, 0);
      EXPECT_GE(e_n, -2e-8);
      if (r_n == 0) {
        ++open;
        EXPECT_EQ(r_t.norm(), 0);
        continue;
      }
      EXPECT_NEAR(e_n, 0, 2e-8);
      EXPECT_LE(r_t.norm(), mu * r_n * (1 + 1e-9) + 1e-15);
      if (r_t.norm() < mu * r_n * (1 - 1e-6)) {
        ++sticking;
        EXPECT_LT(e_t.norm(), 2e-8);
      } else {
        ++slipping;
        EXPECT_LT((e_t.norm() * r_t + mu * r_n * e_t).norm(), 1e-3 * e_t.norm() * mu * r_n + 1e-12);
      }
    }
  }
  EXPECT_GT(open, 20);
  EXPECT_GT(slipping, 20);
  EXPECT_GT(sticking, mu > 0 ? 5 : -1);
}

INSTANTIATE_TEST_SUITE_P(Coefficients, Friction, ::testing::Values(0.0, 0.3, 1.2));

/// A single point whose normal force moves it sideways, which projections in turn do not solve.
TEST(ConeProblem, MuchFrictionAndCouplingAreSolvedExactly) {
  int sticking = 0, slipping = 0;
  for (int seed = 1; seed <= 300; ++seed) {
    const Springs springs(1, seed);
    math::Random random(1000 + seed);
    const double mu = std::exp(random.uniform(std::log(1.0), std::log(50.0)));
    std::vector<ConePoint> points = random_points(1, mu, random);
    ConePoint& point = points[0];
    if (point.normal.dot(point.offset) > 0) point.offset = -point.offset;
    ConeProblem problem(1);
    EXPECT_LT(problem.solve(springs.table, {200, 1e-9}, points), 200) << seed;
    const Vector3d e = errors(springs, points)[0];
    const double r_n = point.normal.dot(point.force), e_n = point.normal.dot(e);
    const Vector3d r_t = point.force - r_n * point.normal, e_t = e - e_n * point.normal;
    // compliances are of single precision, and near jamming forces are large
    const double rounding = 2e-8 + 1e-6 * (springs.compliance * point.force).norm();
    ASSERT_GT(r_n, 0);
    EXPECT_NEAR(e_n, 0, rounding);
    EXPECT_LE(r_t.norm(), mu * r_n * (1 + 1e-9));
    if (r_t.norm() < mu * r_n * (1 - 1e-6)) {
      ++sticking;
      EXPECT_LT(e_t.norm(), rounding) << seed;
    } else {
      ++slipping;
      EXPECT_LT((e_t.norm() * r_t + mu * r_n * e_t).norm(),
                (1e-4 * e_t.norm() + rounding) * mu * r_n)
          << seed;
    }
  }
  EXPECT_GT(sticking, 50);
  EXPECT_GT(slipping, 20);
}

TEST(ConeProblem, AWarmStartAtTheSolutionChangesNothing) {
  const Springs springs(8, 3);
  math::Random random(4);
  std::vector<ConePoint> points = random_points(8, 0.4, random);
  ConeProblem problem(8);
  problem.solve(springs.table, {500, 1e-11}, points);
  // the forces are now part of what acts, and the offsets what they leave
  const std::vector<Vector3d> all = errors(springs, points);
  std::vector<ConePoint> again = points;
  for (int k = 0; k < 8; ++k) again[k].offset = all[k];
  EXPECT_LE(problem.solve(springs.table, {500, 1e-7}, again), 2);
  for (int k = 0; k < 8; ++k) EXPECT_LT((again[k].force - points[k].force).norm(), 2e-5);
}

TEST(ConeProblem, CompliancesThatChangeAreUsedOnceTheyAreForgotten) {
  const Springs first(6, 7), second(6, 8);
  math::Random random(9);
  const std::vector<ConePoint> posed = random_points(6, 0.3, random);
  ConeProblem used(6), fresh(6);
  std::vector<ConePoint> points = posed, expected = posed;
  used.solve(first.table, {500, 1e-11}, points);
  points = posed;
  used.forget_compliances();
  used.solve(second.table, {500, 1e-11}, points);
  fresh.solve(second.table, {500, 1e-11}, expected);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(points[k].force, expected[k].force);
}

TEST(ComplianceColumns, APlaceCanBeTakenByAnotherSample) {
  Springs springs(5, 6);
  ComplianceColumns table(springs.samples, 5, 3);
  Eigen::VectorXf b(15);
  const auto solve = [&](Eigen::VectorXf& force) {
    force = (springs.compliance * force.cast<double>()).cast<float>();
  };
  for (int k = 0; k < 3; ++k) table.add(k, k, b, solve);
  EXPECT_TRUE(table.is_full());
  table.add(4, 1, b, solve);
  EXPECT_EQ(table.place(1), -1);
  EXPECT_EQ(table.place(4), 1);
  const int samples[3] = {0, 4, 2};
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 3; ++q) {
      const Eigen::Matrix3d block = table.among(q).middleRows<3>(3 * p).cast<double>();
      EXPECT_LT((block - springs.compliance.block<3, 3>(3 * samples[p], 3 * samples[q])).norm(),
                1e-8);
    }
  }
  table.clear();
  EXPECT_EQ(table.count(), 0);
  EXPECT_EQ(table.place(4), -1);
}

}  // namespace
}  // namespace palpate::elasticity
