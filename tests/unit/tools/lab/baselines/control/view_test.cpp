#include <gtest/gtest.h>

#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"
#include "tools/lab/baselines/control/fourier_view.hpp"
#include "tools/lab/baselines/control/two_camera_view.hpp"

namespace palpate::baselines {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

class Views : public ::testing::Test {
 protected:
  elasticity::Body body_ = support::held_bar({6, 1, 1}, mesh::ElementOrder::kLinear);
  shape::PointsFeature square_{body_.mesh,
                               {{{0.1, 0, 0.03},
                                 {0.2, 0, 0.03},
                                 {0.3, 0, 0.03},
                                 {0.3, 0.06, 0.03},
                                 {0.2, 0.06, 0.03},
                                 {0.1, 0.06, 0.03}}}};
};

TEST_F(Views, PlainOnesRefuseFeaturesWhoseErrorIsNoDifference) {
  PlainView view;
  view.resize(square_);
  EXPECT_EQ(view.rows(), 18);
  shape::PoseFeature pose(body_.mesh, {{Vector3d(0.20, 0.01, 0.02), Vector3d(0.27, 0.03, 0.05),
                                        Vector3d(0.23, 0.055, 0.01)}});
  EXPECT_THROW(view.resize(pose), std::invalid_argument);
  shape::DistanceFeature distance(body_.mesh, {{{0.1, 0, 0}, {0.3, 0, 0}}});
  EXPECT_NO_THROW(view.resize(distance));
  EXPECT_THROW(FourierView({}).resize(distance), std::invalid_argument);
  EXPECT_THROW(TwoCameraView({}).resize(distance), std::invalid_argument);
}

TEST_F(Views, FourierHoldsTheMeanAndGivesBackWhatItHolds) {
  FourierView view({1, true});
  view.resize(square_);
  ASSERT_EQ(view.rows(), 9);
  VectorXd value(18), seen(9);
  square_.evaluate(body_.mesh.nodes, value);
  view.measure(value, seen);
  // Translation of a contour changes only the mean.
  VectorXd shifted = value, seen_shifted(9);
  for (int p = 0; p < 6; ++p) shifted.segment<3>(3 * p) += Vector3d(0.01, -0.02, 0.03);
  view.measure(shifted, seen_shifted);
  EXPECT_LT((seen_shifted - seen - (VectorXd(9) << 0.01, -0.02, 0.03, 0, 0, 0, 0, 0, 0).finished())
                .norm(),
            1e-12);
  // A Jacobian of coefficients, made one of points, has these coefficients.
  const MatrixXd J_seen = MatrixXd::Random(9, 6);
  MatrixXd J(18, 6);
  view.express(J_seen, J);
  for (int k = 0; k < 6; ++k) {
    VectorXd back(9);
    view.measure(J.col(k), back);
    EXPECT_LT((back - J_seen.col(k)).norm(), 1e-12);
  }
}

TEST_F(Views, FourierOfOnePointIsThePoint) {
  shape::PointFeature point(body_.mesh, {{0.25, 0.03, 0.06}, {0, 1, 2}});
  FourierView view({4, true});
  view.resize(point);
  ASSERT_EQ(view.rows(), 3);
  VectorXd seen(3);
  const VectorXd value = Vector3d(1, 2, 3);
  view.measure(value, seen);
  EXPECT_LT((seen - value).norm(), 1e-14);
}

TEST_F(Views, TwoCamerasSeeWhatTheirPinholesSay) {
  TwoCameraView view({});
  view.resize(square_);
  ASSERT_EQ(view.rows(), 24);
  VectorXd value(18), seen(24), moved(24);
  square_.evaluate(body_.mesh.nodes, value);
  view.measure(value, seen);
  EXPECT_LT(seen.cwiseAbs().maxCoeff(), 320) << "the object is in the pictures, px";
  // The images of a motion, learnt as a Jacobian, reproduce that motion.
  MatrixXd J_seen(24, 6), J(18, 6), motions(18, 6);
  const double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    motions.col(k) = VectorXd::Random(18);
    const VectorXd at = value + h * motions.col(k);
    view.measure(at, moved);
    J_seen.col(k) = (moved - seen) / h;
  }
  view.measure(value, seen);
  view.express(J_seen, J);
  EXPECT_LT((J - motions).norm() / motions.norm(), 1e-4);
}

}  // namespace
}  // namespace palpate::baselines
