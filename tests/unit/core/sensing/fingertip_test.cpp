#include <gtest/gtest.h>

#include <cmath>

#include "core/math/random.hpp"
#include "core/sensing/biotac_linear.hpp"
#include "core/sensing/manual.hpp"

namespace palpate::sensing {
namespace {

constexpr int kFingertipE17 = 16, kE2 = 1, kE12 = 11;

TEST(BiotacGeometry, MirrorsItselfAboutTheMiddlePlane) {
  // E1 to E6 are opposite E11 to E16, E8 is opposite E9.
  const Eigen::Vector3d mirror(1, -1, 1);
  const auto& p = electrode_positions();
  const auto& n = electrode_normals();
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT((p.col(i).cwiseProduct(mirror) - p.col(i + 10)).norm(), 1e-12) << i;
    EXPECT_LT((n.col(i).cwiseProduct(mirror) - n.col(i + 10)).norm(), 1e-12) << i;
  }
  EXPECT_LT((p.col(7).cwiseProduct(mirror) - p.col(8)).norm(), 1e-12);
  for (int i = 0; i < kElectrodeCount; ++i) EXPECT_NEAR(n.col(i).norm(), 1, 2e-3) << i;
}

TEST(BiotacGeometry, ProjectsOnCylinderAndSphere) {
  EXPECT_LT((project_on_skin({-5e-3, 0, -1e-3}) - Eigen::Vector3d(-5e-3, 0, -7e-3)).norm(), 1e-15);
  EXPECT_LT((project_on_skin({3e-3, 0, -4e-3}) - Eigen::Vector3d(4.2e-3, 0, -5.6e-3)).norm(),
            1e-15);
  EXPECT_LT((project_on_skin({0, 0, 0}) - Eigen::Vector3d(0, 0, -7e-3)).norm(), 1e-15);
}

TEST(LocateContact, OneElectrodeIsItsOwnPlaceOnTheSkin) {
  ElectrodeVector counts = ElectrodeVector::Zero();
  counts[kFingertipE17] = 50;
  const Localization found = locate_contact(counts, {});
  EXPECT_EQ(found.active, 1);
  EXPECT_LT((found.location - Eigen::Vector3d(-2.8e-3, 0, -7e-3)).norm(), 1e-12);
}

TEST(LocateContact, PolarityChoosesWhichElectrodesArePressed) {
  ElectrodeVector counts = ElectrodeVector::Zero();
  counts[kE2] = 50;
  counts[kE12] = -50;
  LocalizationOptions options;
  EXPECT_LT(locate_contact(counts, options).location.y(), 0);
  options.polarity = -1;
  EXPECT_GT(locate_contact(counts, options).location.y(), 0);
  options.threshold = 60;
  EXPECT_EQ(locate_contact(counts, options).active, 0);
}

TEST(LocateContact, PublishedVariantDividesThePullByTheNumberOfElectrodes) {
  // Two electrodes at y = -+3.513 mm and the same x and z, intensities 1 and 0.5: centroid y 0,
  // weighted centroid y = -3.513 / 3 mm, the published one half of that.
  ElectrodeVector counts = ElectrodeVector::Zero();
  counts[kE2] = 100;
  counts[kE12] = 50;
  LocalizationOptions options;
  const auto expect_y = [&](double y) {
    const Eigen::Vector3d on_skin = project_on_skin({-2.7e-3, y, -3.67e-3});
    EXPECT_LT((locate_contact(counts, options).location - on_skin).norm(), 1e-12);
  };
  options.weighting = Weighting::kCentroid;
  expect_y(-3.513e-3 / 3);
  options.weighting = Weighting::kPublished;
  expect_y(-3.513e-3 / 6);
  counts[kE2] = 5000;  // intensity saturates
  expect_y(-3.513e-3 / 6);
}

/// Forces from a known map of random counts, with noise.
struct TactileData {
  TactileData(int rows, double noise) : inputs(rows, kTactileInputCount), forces(rows, 3) {
    math::Random random(11);
    for (int c = 0; c < kTactileInputCount; ++c)
      for (int r = 0; r < 3; ++r) truth.matrix(r, c) = random.uniform(-0.01, 0.01);
    truth.offset << 0.1, -0.2, 0.3;
    for (int i = 0; i < rows; ++i) {
      for (int c = 0; c < kTactileInputCount; ++c) inputs(i, c) = random.uniform(-100, 100);
      forces.row(i) = truth.force(inputs.row(i).transpose()).transpose();
      for (int r = 0; r < 3; ++r) forces(i, r) += noise * random.normal();
    }
  }
  LinearTactileModel truth;
  Eigen::MatrixXd inputs, forces;
};

TEST(FitLinearTactile, RecoversAKnownMap) {
  const TactileData data(600, 0.01);
  const LinearTactileFit fit = fit_linear_tactile(data.inputs, data.forces);
  EXPECT_LT((fit.model.matrix - data.truth.matrix).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((fit.model.offset - data.truth.offset).norm(), 5e-3);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(fit.training_rms[axis], 0.01, 0.001);
    EXPECT_NEAR(fit.cross_validated_rms[axis], 0.01, 0.002);
  }
  EXPECT_LE(fit.penalty, 1e-4);  // plenty of data, hardly any noise
}

TEST(FitLinearTactile, DoesNotBlowUpAChannelThatStandsStill) {
  TactileData data(300, 0.01);
  for (int i = 0; i < 300; ++i) data.inputs(i, 7) = 1e-6 * (i % 2);
  const LinearTactileFit fit = fit_linear_tactile(data.inputs, data.forces);
  EXPECT_LT(fit.model.matrix.col(7).norm(), 1);  // N per count, where 1e-6 counts were measured
  EXPECT_TRUE(fit.model.matrix.allFinite());
}

TEST(FitLinearTactile, GivesNothingForNothingWithoutOffset) {
  const TactileData data(300, 0.01);
  LinearTactileFitOptions options;
  options.with_offset = false;
  const LinearTactileFit fit = fit_linear_tactile(data.inputs, data.forces, options);
  EXPECT_EQ(fit.model.offset.norm(), 0);
}

TEST(FitLinearTactile, RefusesDataThatCannotBeFitted) {
  const TactileData data(8, 0);
  EXPECT_THROW(fit_linear_tactile(data.inputs, data.forces), std::invalid_argument);
  EXPECT_THROW(fit_linear_tactile(data.inputs, data.forces.topRows(4)), std::invalid_argument);
}

BioTac fingertip_at_rest() {
  BioTac sample;
  sample.electrodes.setConstant(3200);
  sample.pac = 2030;
  sample.pdc = 1970;
  return sample;
}

void feed(Signals& signals, int finger, const BioTac& sample) {
  auto& stream = signals.biotac[finger];
  stream.freshness = Freshness::kNew;
  stream.age = 0;
  stream.latest = stream.fresh[0] = sample;
  stream.fresh_count = 1;
}

/// Force along -z, 1 mN per count of PDC.
BiotacLinear::Options pdc_options() {
  BiotacLinear::Options options;
  options.finger = 2;
  options.model.matrix(2, kElectrodeCount + 1) = -1e-3;
  options.tare_samples = 3;
  return options;
}

/// A sensor that has been tared at rest.
class ZeroedFinger : public ::testing::Test {
 protected:
  ZeroedFinger() {
    for (int i = 0; i < pdc_options().tare_samples; ++i) read(fingertip_at_rest());
  }

  Status read(const BioTac& sample) {
    feed(signals, 2, sample);
    return sensor.update(signals, contacts = {}).status;
  }

  BiotacLinear sensor{pdc_options()};
  Signals signals;
  ContactSet contacts;
};

TEST_F(ZeroedFinger, ReportsForceAndPlaceBetweenItsGates) {
  BioTac pressed = fingertip_at_rest();
  pressed.electrodes[kFingertipE17] += 40;
  const auto contacts_at = [&](double pdc) {
    pressed.pdc = fingertip_at_rest().pdc + pdc;
    EXPECT_EQ(read(pressed), Status::kOk);
    return contacts.count;
  };
  EXPECT_EQ(contacts_at(140), 0);  // below the gate of 150 mN
  ASSERT_EQ(contacts_at(200), 1);
  const Contact& contact = contacts.contacts[0];
  EXPECT_EQ(contact.source, Source::kFinger2);
  EXPECT_NEAR(contact.wrench.force.z(), -0.2, 1e-12);
  EXPECT_LT((contact.location - Eigen::Vector3d(-2.8e-3, 0, -7e-3)).norm(), 1e-12);
  EXPECT_EQ(contacts_at(110), 1);  // not yet released
  EXPECT_EQ(contacts_at(90), 0);
  EXPECT_EQ(contacts_at(110), 0);  // not yet touched again
}

TEST_F(ZeroedFinger, HoldsThePlaceOfItsContactWhenNoElectrodeIsActive) {
  BioTac pressed = fingertip_at_rest();
  pressed.pdc += 300;
  read(pressed);
  EXPECT_EQ(contacts.count, 0);
  pressed.electrodes[kFingertipE17] += 40;
  read(pressed);
  ASSERT_EQ(contacts.count, 1);
  const Eigen::Vector3d place = contacts.contacts[0].location;
  pressed.electrodes = fingertip_at_rest().electrodes;
  EXPECT_EQ(read(pressed), Status::kOk);
  EXPECT_EQ(contacts.contacts[0].location, place);
}

TEST_F(ZeroedFinger, DegradesWhereAForceLastsThatNoElectrodeCanPlace) {
  BioTac pressed = fingertip_at_rest();
  pressed.pdc += 300;
  const auto reads = [&](const BioTac& sample) {
    const Status status = read(sample);
    EXPECT_EQ(contacts.count, 0);
    return status;
  };
  for (int again = 0; again < 2; ++again) {  // noise: a few readings of a force, then none again
    for (int i = 0; i < PlacelessForce::kMost; ++i) EXPECT_EQ(reads(pressed), Status::kOk) << i;
    if (again == 0) {
      EXPECT_EQ(reads(fingertip_at_rest()), Status::kOk);
    }
  }
  EXPECT_EQ(reads(pressed), Status::kDegraded);
  signals.biotac[2].fresh_count = 0;  // between readings
  EXPECT_EQ(sensor.update(signals, contacts = {}).status, Status::kDegraded);
  EXPECT_EQ(reads(fingertip_at_rest()), Status::kOk);
}

TEST(BiotacLinear, DegradesWhenItsFingerIsSilentAndCountsBadSamples) {
  BiotacLinear sensor(pdc_options());
  Signals signals;
  ContactSet contacts;
  feed(signals, 0, fingertip_at_rest());  // another finger
  EXPECT_EQ(sensor.update(signals, contacts).status, Status::kDegraded);
  BioTac broken = fingertip_at_rest();
  broken.electrodes[4] = NAN;
  feed(signals, 2, broken);
  static_cast<void>(sensor.update(signals, contacts));
  EXPECT_EQ(sensor.skipped(), 1);
  for (int i = 0; i < 3; ++i) {
    feed(signals, 2, fingertip_at_rest());
    static_cast<void>(sensor.update(signals, contacts));
  }
  EXPECT_EQ(sensor.update(signals, contacts).status, Status::kOk);
  signals.biotac[2].age = 0.2;
  EXPECT_EQ(sensor.update(signals, contacts).status, Status::kDegraded);
}

TEST(Manual, ExpiresUnlessRenewed) {
  Manual sensor;
  Signals signals;
  ContactSet contacts;
  EXPECT_EQ(sensor.update(signals, contacts).status, Status::kOk);
  EXPECT_EQ(contacts.count, 0);
  signals.manual.freshness = Freshness::kNew;
  signals.manual.age = 0;
  signals.manual.latest = {{0.1, 0.2, 0.3}, {0, 0, -2}};
  static_cast<void>(sensor.update(signals, contacts = {}));
  ASSERT_EQ(contacts.count, 1);
  EXPECT_EQ(contacts.contacts[0].source, Source::kManual);
  EXPECT_EQ(contacts.contacts[0].location, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(contacts.contacts[0].wrench.force.z(), -2);
  signals.manual.freshness = Freshness::kOld;
  signals.manual.age = 0.11;
  static_cast<void>(sensor.update(signals, contacts = {}));
  EXPECT_EQ(contacts.count, 0);
}

TEST(Manual, ShortensForcesBeyondItsLimit) {
  Manual sensor(Manual::Options{0.1, 5});
  Signals signals;
  ContactSet contacts;
  signals.manual.freshness = Freshness::kNew;
  signals.manual.age = 0;
  signals.manual.latest.force_O = {0, 30, 40};
  static_cast<void>(sensor.update(signals, contacts));
  EXPECT_LT((contacts.contacts[0].wrench.force - Eigen::Vector3d(0, 3, 4)).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate::sensing
