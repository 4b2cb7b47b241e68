// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/wing_course.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace jink::app {
namespace {

Vec3 at_angle(float degrees, float speed, float climb = 0.0F)
{
    const float a = degrees * kPi / 180.0F;
    return {speed * std::cos(a), speed * std::sin(a), climb};
}

float degrees_of(const Vec3& v) { return std::atan2(v.y(), v.x()) * 180.0F / kPi; }

TEST(WingCourse, LeavesCommandsThatAreNoReversalAsTheyAre)
{
    for (const float angle : {0.0F, 40.0F, -90.0F, 134.0F, -134.0F}) {
        const Vec3 command = at_angle(angle, 12.0F, -1.0F);
        EXPECT_EQ(wing_course(command, Vec3(18, 0, 0), at_angle(-angle, 18.0F)), command) << angle;
    }
    EXPECT_EQ(wing_course(Vec3::Zero(), Vec3(18, 0, 0), Vec3::Zero()), Vec3::Zero());
    EXPECT_EQ(wing_course(Vec3(-5, 0, 0), Vec3::Zero(), Vec3::Zero()), Vec3(-5, 0, 0)) << "no own course";
}

// Regression: the side changed from tick to tick, and the plane flew straight on until reported as not following.
TEST(WingCourse, AReversalKeepsTheSideThatItBeganWith)
{
    Vec3 own(18, 0, 0);
    Vec3 sent = wing_course(at_angle(179.0F, 18.0F), own, own);
    EXPECT_NEAR(degrees_of(sent), 120.0F, 0.1F);
    for (int i = 0; i < 10; ++i) {
        const Vec3 command = at_angle(i % 2 == 0 ? -176.0F : 176.0F, 18.0F, 1.5F);
        sent = wing_course(command, own, sent);
        EXPECT_GT(sent.x() * -own.y() + sent.y() * own.x(), 0.0F) << "left all along";
        EXPECT_NEAR(std::hypot(sent.x(), sent.y()), 18.0F, 0.01F);
        EXPECT_EQ(sent.z(), 1.5F);
        own = at_angle(3.0F * static_cast<float>(i + 1), 18.0F);
    }
}

/// Degrees from one course to another, -180 to 180.
float turned(const Vec3& from, const Vec3& to) { return std::remainder(degrees_of(to) - degrees_of(from), 360.0F); }

TEST(WingCourse, IsTheSameOnEveryOwnCourse)
{
    for (int i = 0; i < 24; ++i) {
        const float heading = 15.0F * static_cast<float>(i);
        const Vec3 own = at_angle(heading, 18.0F);
        for (const float side : {-1.0F, 1.0F}) {
            const Vec3 wide = at_angle(heading + side * 134.0F, 12.0F, 1.0F);
            EXPECT_EQ(wing_course(wide, own, own), wide) << heading;
            const Vec3 back = wing_course(at_angle(heading + side * 137.0F, 12.0F, 1.0F), own, own);
            EXPECT_NEAR(turned(own, back), side * 120.0F, 0.1F) << heading << ": on the command's own side";
            EXPECT_NEAR(std::hypot(back.x(), back.y()), 12.0F, 0.01F);
            const Vec3 kept =
                wing_course(at_angle(heading - side * 170.0F, 12.0F), own, at_angle(heading + side * 30.0F, 18.0F));
            EXPECT_NEAR(turned(own, kept), side * 120.0F, 0.1F) << heading << ": on the side sent before";
            const Vec3 unclear =
                wing_course(at_angle(heading - side * 170.0F, 12.0F), own, at_angle(heading + side * 9.0F, 18.0F));
            EXPECT_NEAR(turned(own, unclear), side * -120.0F, 0.1F) << heading << ": sent before on none clearly";
        }
    }
}

}  // namespace
}  // namespace jink::app
