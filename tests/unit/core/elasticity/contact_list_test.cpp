#include "core/elasticity/contact/contact_list.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/contact/obstacle_contacts.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

/// A bar whose lower side is at z = 0, above a plane at a height.
class Above {
 public:
  explicit Above(double height, int most = 160) : body_(bar()), boundary_(body_) {
    options_.obstacles = {plane({0, 0, height}, {0, 0, 1}, 0.5)};
    options_.most = most;
    samples_ = ObstacleContacts::numbered_samples(body_, options_);
    list_ = std::make_unique<ContactList>(body_, boundary_, options_, samples_);
  }

  ContactList& list() { return *list_; }
  /// Positions at rest, lowered.
  NodalField lowered(double by) const {
    NodalField x = body_.rest;
    x.row(2).array() -= by;
    return x;
  }

 private:
  NumberedBody body_;
  BoundaryConditions boundary_;
  ContactOptions options_;
  std::vector<mesh::PointWeights> samples_;
  std::unique_ptr<ContactList> list_;
};

TEST(ContactList, ListsPointsWithinReachAndSelectsThoseThatCanClose) {
  Above above(-5e-3);
  ContactList& list = above.list();
  list.begin_step(above.lowered(0));
  EXPECT_TRUE(list.contacts().empty());  // farther than the reach of 2 mm

  list.begin_step(above.lowered(4e-3));
  const std::size_t listed = list.contacts().size();
  ASSERT_GT(listed, 10u);
  for (const SurfaceContact& contact : list.contacts()) {
    EXPECT_NEAR(contact.gap, 1e-3, 1e-12);
    EXPECT_NEAR(contact.normal.z(), 1, 1e-12);
    EXPECT_TRUE(list.contains(contact.sample));
  }

  list.begin_step(above.lowered(4e-3));  // at rest: nothing closes
  EXPECT_TRUE(list.close().empty());
  list.look_ahead(above.lowered(4e-3), 0.1e-3);
  EXPECT_TRUE(list.close().empty());
  list.look_ahead(above.lowered(4e-3), 1.1e-3);
  EXPECT_EQ(list.close().size(), listed);
}

TEST(ContactList, AnObstacleThatIsPlacedElsewhereIsSearchedAgain) {
  Above above(-5e-3);
  ContactList& list = above.list();
  list.begin_step(above.lowered(0));
  ASSERT_TRUE(list.contacts().empty());
  collision::Placement risen;
  risen.X_OB.translation().z() = -0.5e-3;
  list.place(0, risen);
  list.begin_step(above.lowered(0));
  ASSERT_FALSE(list.contacts().empty());
  EXPECT_NEAR(list.contacts().front().gap, 0.5e-3, 1e-12);
  risen.is_known = false;
  list.place(0, risen);
  list.begin_step(above.lowered(0));
  EXPECT_TRUE(list.contacts().empty());
}

TEST(ContactList, SlipCountsFromTheAnchorOnTheObstacle) {
  Above above(0);
  ContactList& list = above.list();
  list.begin_step(above.lowered(0));
  ASSERT_FALSE(list.contacts().empty());
  SurfaceContact& contact = list.contact(0);
  list.evaluate(contact, above.lowered(0));
  list.anchor(contact);
  EXPECT_EQ(contact.slip.norm(), 0);
  NodalField x = above.lowered(1e-4);
  x.row(0).array() += 3e-4;
  list.evaluate(contact, x);
  EXPECT_LT((contact.slip - Vector3d(3e-4, 0, 0)).norm(), 1e-12);  // across the normal
  collision::Placement moved;
  moved.X_OB.translation() << 3e-4, 0, -1e-4;
  list.place(0, moved);
  list.evaluate(contact, x);
  EXPECT_LT(contact.slip.norm(), 1e-12);  // it has moved along
}

TEST(ContactList, TheNearestAndThosePressedAreKeptAndTheOthersCounted) {
  Above above(0, 6);
  ContactList& list = above.list();
  list.begin_step(above.lowered(0));
  ASSERT_EQ(list.contacts().size(), 6u);
  EXPECT_GT(list.omitted(), 0);
  const int sample = list.contacts().back().sample;
  list.contact(5).force = Vector3d::UnitZ();
  list.begin_step(above.lowered(-1e-3));  // listed again, all equally far
  EXPECT_TRUE(list.contains(sample));
  list.clear();
  EXPECT_TRUE(list.contacts().empty());
}

}  // namespace
}  // namespace palpate::elasticity
