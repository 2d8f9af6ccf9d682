// SPDX-License-Identifier: Apache-2.0
// The smoother's linear models are the filter's.
#include "gatefly/tasks/smoothing/linear_model.hpp"

#include <gtest/gtest.h>

#include "gatefly/geometry/rotation_vector.hpp"

#include "support/generators.hpp"

namespace gatefly::smoothing {
namespace {

using namespace eskf;
using test::normal;

Nominal some_belief(Rng& rng) {
  Nominal x;
  ErrorVector e(kGates);
  for (int i = 0; i < kGates; ++i) e(i) = 0.3 * normal(rng);
  add(x, e);
  x.gust_sigma = 0.4, x.accel_shaking = 1.5, x.gyro_shaking = 0.7;
  return x;
}

std::vector<Sample> some_samples(Rng& rng) {
  std::vector<Sample> samples(4);
  for (Sample& s : samples) {
    s.dt = 1.0 / 512.0;
    for (int i = 0; i < 3; ++i) {
      s.imu.gyro_B(i) = normal(rng);
      s.imu.accel_B(i) = 3.0 * normal(rng);
    }
  }
  return samples;
}

TEST(SmootherModel, ATickCarriesEveryCovarianceAsTheFilterDoes) {
  Rng rng{7};
  const eskf::Setup setup;
  const Nominal x = some_belief(rng);
  const auto samples = some_samples(rng);
  Eigen::MatrixXd A(kGates, kGates);
  for (double& a : A.reshaped()) a = normal(rng);
  Covariance P = A * A.transpose();
  const Eigen::MatrixXd before = P;
  Nominal by_filter = x, by_smoother = x;
  predict(by_filter, P, samples, setup.params, setup.camera.radians_per_px);
  const Step step = step_of(by_smoother, samples, setup);
  Eigen::MatrixXd F = step.kept.asDiagonal();
  F.topLeftCorner<kMoving, kMoving>() = step.F;
  Eigen::MatrixXd expected = F * before * F.transpose();
  expected.diagonal() += step.noise;
  EXPECT_LT((expected - P).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(by_filter.p_EB, by_smoother.p_EB);
  EXPECT_LT((step.times(BaseVector::Ones()) - F * BaseVector::Ones()).norm(), 1e-12);
  EXPECT_LT((step.transposed_times(BaseVector::Ones()) - F.transpose() * BaseVector::Ones()).norm(),
            1e-12);
}

TEST(SmootherModel, TheDifferenceIsTheErrorThatWasAdded) {
  Rng rng{8};
  const Nominal from = some_belief(rng);
  for (int i = 0; i < kGates; ++i) {
    ErrorVector e = ErrorVector::Zero(kGates);
    e(i) = 0.2;
    Nominal to = from;
    add(to, e);
    EXPECT_LT((difference(to, from) - e).norm(), 1e-9) << "state " << i;
  }
}

}  // namespace
}  // namespace gatefly::smoothing
