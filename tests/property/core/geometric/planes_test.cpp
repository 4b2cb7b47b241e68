// SPDX-License-Identifier: BSD-3-Clause
// Plane checks: never "apart" for contact, never "touches" for clear cases, against least-norm points in double; and
// most intended cases are decided.
#include "core/geometric/planes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/property/core/geometry/convex_oracle.hpp"

namespace jink::geometric {
namespace {

using geometry::ShapeKind;
using geometry::oracle::any_shape;
using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;

constexpr std::array kKinds{ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder,
                            ShapeKind::hull};

struct Seen {
    unsigned clear = 0, parted = 0;  ///< farther than the clearance, and reported so
    unsigned near = 0, touched = 0;  ///< a static box well within the clearance, and reported so
};

/// A curve of points a and b alone.
detail::Curve curve_of(const Vec3& a, const Vec3& b)
{
    detail::Curve curve;
    curve.points = 2;
    curve.x[0] = a.x();
    curve.y[0] = a.y();
    curve.z[0] = a.z();
    curve.x[1] = b.x();
    curve.y[1] = b.y();
    curve.z[1] = b.z();
    curve.t[1] = 1.0F;
    return curve;
}

TEST(PlanesLaw, NothingIsReportedThatIsNotSo)
{
    Random random(seed_of(811));
    std::array<Seen, kKinds.size()> seen{};
    const std::size_t count = case_count(20'000);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = i % kKinds.size();
        std::vector<Point3> vertices;
        const Vec3 centre = in_cube(random, 40.0F);
        const geometry::Shape shape = any_shape(random, kKinds[k], centre, random.uniform(0.2F, 12.0F), vertices);
        const Vec3 half(random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F));
        const Vec3 a = centre + in_cube(random, random.below(2) == 0 ? 8.0F : 25.0F);
        const Vec3 b = random.below(3) == 0 ? Vec3(a + in_cube(random, 0.5F)) : Vec3(centre + in_cube(random, 25.0F));
        const detail::Planes planes(shape, shape.centre);
        const auto way = geometry::oracle::swept_box_bounds(half, a, b, shape, 1e-7);
        // About their distance, or zero, or any value.
        const float d = static_cast<float>(way.upper);
        const float clearance = random.below(3) == 0   ? 0.0F
                                : random.below(2) == 0 ? d * random.uniform(0.98F, 1.01F)
                                                       : random.uniform(0.0F, 5.0F);
        const bool parted = planes.part(a, b, half, clearance);
        ASSERT_TRUE(!parted || way.upper > double(clearance)) << i;
        const detail::Curve curve = curve_of(a, b);
        ASSERT_TRUE(!planes.part(detail::view_of(curve), half, clearance) || way.upper > double(clearance)) << i;
        const auto rest = geometry::oracle::swept_box_bounds(half, a, a, shape, 1e-7);
        const bool touched = planes.touch(a, half, clearance);
        ASSERT_TRUE(!touched || rest.lower < double(clearance) || rest.lower == 0.0) << i;
        Seen& s = seen[k];
        const bool clear = way.upper > 1.05 * double(clearance) + 0.1;
        s.clear += clear ? 1U : 0U;
        s.parted += clear && parted ? 1U : 0U;
        const bool near = rest.upper < double(clearance + half.minCoeff()) - 1.0;
        s.near += near ? 1U : 0U;
        s.touched += near && touched ? 1U : 0U;
    }
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
        EXPECT_GE(seen[k].parted, 2 * seen[k].clear / 3) << k;
        EXPECT_EQ(seen[k].touched > 0, kKinds[k] != ShapeKind::hull);
        if (kKinds[k] != ShapeKind::hull) {
            EXPECT_GE(seen[k].touched, seen[k].near / 4) << k;
        }
    }
}

/// Nearly coincident faces: the result is on the safe side of rounding.
TEST(PlanesLaw, AHairIsNeverTakenForRoom)
{
    Random random(seed_of(812));
    unsigned reported = 0;
    for (std::size_t i = 0; i < case_count(20'000); ++i) {
        const Vec3 centre = in_cube(random, random.below(2) == 0 ? 3.0F : 300.0F);
        const Vec3 size(random.uniform(0.5F, 20.0F), random.uniform(0.5F, 20.0F), random.uniform(0.5F, 20.0F));
        const bool is_box = random.below(2) == 0;
        const geometry::Shape shape = is_box ? geometry::make_box(centre, size)
                                             : geometry::make_cylinder(centre - Vec3(0.0F, 0.0F, size.z()),
                                                                       centre + Vec3(0.0F, 0.0F, size.z()), size.x());
        const Vec3 half = Vec3::Constant(random.uniform(0.2F, 1.0F));
        const int axis = is_box ? static_cast<int>(random.below(3)) : 2;
        const float side = random.below(2) == 0 ? 1.0F : -1.0F;
        const float hair = random.uniform(-3e-5F, 3e-4F) * (1.0F + size.norm());
        Vec3 a = centre + 0.5F * in_cube(random, 0.5F);
        Vec3 b = centre + 0.5F * in_cube(random, 0.5F);
        a[axis] = b[axis] = centre[axis] + side * (size[axis] + half[axis] + hair);
        const double gap = std::abs(double(a[axis]) - double(centre[axis])) - double(size[axis]) - double(half[axis]);
        const detail::Planes planes(shape, shape.centre);
        const bool parted = planes.part(a, b, half, 0.0F);
        reported += parted ? 1U : 0U;
        ASSERT_TRUE(!parted || gap > 0.0) << i << ": " << gap;
        const detail::Curve curve = curve_of(a, b);
        const bool all = planes.part(detail::view_of(curve), half, 0.0F);
        ASSERT_TRUE(!all || gap > 0.0) << i << ": " << gap;
        // Static: within this clearance contact, beyond it none.
        const bool touched = planes.touch(a, half, 0.0F);
        ASSERT_TRUE(!touched || gap < 0.0) << i << ": " << gap;
    }
    EXPECT_GT(reported, case_count(20'000) / 4) << "a hair that rounding cannot reach is seen";
}

/// One end of the path barely in contact, with large terms in the slack: distant, wide and long bodies. For any order
/// of summation, rounding stays on the safe side.
TEST(PlanesLaw, AHairIsNeverTakenForRoomOfWhatIsLarge)
{
    Random random(seed_of(813));
    const std::size_t count = case_count(10'000);
    unsigned reported = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto length = [&] { return std::pow(10.0F, random.uniform(-1.0F, 2.5F)); };
        const Vec3 size(length(), length(), length());
        const Vec3 half(length(), length(), length());
        const int axis = static_cast<int>(random.below(3));
        const float side = random.below(2) == 0 ? 1.0F : -1.0F;
        const float hair = random.uniform(-3e-4F, 3e-4F) * (1.0F + (random.below(2) == 0 ? size.sum() : half.sum()));
        Vec3 near = Vec3::Zero();
        near[axis] = side * (size[axis] + half[axis] + hair);
        Vec3 far = in_cube(random, 300.0F);
        far[axis] = side * std::abs(far[axis]) + near[axis];
        const bool comes = random.below(2) == 0;
        const Vec3& a = comes ? far : near;
        const Vec3& b = comes ? near : far;
        const detail::Planes planes(geometry::make_box(Vec3::Zero(), size), Vec3::Zero());
        const double gap = std::abs(double(near[axis])) - double(size[axis]) - double(half[axis]);
        const bool parted = planes.part(a, b, half, 0.0F);
        ASSERT_TRUE(!parted || gap > 0.0) << i << ": " << gap;
        const detail::Curve curve = curve_of(a, b);
        ASSERT_TRUE(!planes.part(detail::view_of(curve), half, 0.0F) || gap > 0.0) << i << ": " << gap;
        reported += parted ? 1U : 0U;
    }
    EXPECT_GT(reported, count / 20) << "some hairs are longer than rounding";
}

/// A path that stays beyond one face of a box, or one flat end of a round body, is always separated from it.
TEST(PlanesLaw, WhatStaysBeyondAFaceIsParted)
{
    Random random(seed_of(814));
    for (std::size_t i = 0; i < case_count(3'000); ++i) {
        const ShapeKind kind = std::array{ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder}[i % 3];
        std::vector<Point3> none;
        const Vec3 centre = in_cube(random, 20.0F);
        const geometry::Shape shape = any_shape(random, kind, centre, 8.0F, none);
        const Vec3 half(random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F));
        const int face = kind == ShapeKind::box ? static_cast<int>(random.below(3)) : 2;
        const Vec3 out = (random.below(2) == 0 ? 1.0F : -1.0F) * shape.axes.col(face);
        const float clearance = random.uniform(0.0F, 2.0F);
        const float least = (geometry::support(shape, out) - centre).dot(out) + half.dot(out.cwiseAbs()) + clearance;
        const auto beyond = [&] {
            const Vec3 any = in_cube(random, 40.0F);
            return Vec3(centre + any + (least + random.uniform(0.02F, 3.0F) - any.dot(out)) * out);
        };
        const Vec3 a = beyond();
        const Vec3 b = beyond();
        const detail::Planes planes(shape, shape.centre);
        ASSERT_TRUE(planes.part(a, b, half, clearance)) << i;
        const detail::Curve curve = curve_of(a, b);
        ASSERT_TRUE(planes.part(detail::view_of(curve), half, clearance)) << i;
    }
}

/// At rest beside something round, wherever along it, or anywhere about a sphere.
TEST(PlanesLaw, WhatRestsBesideSomethingRoundIsParted)
{
    Random random(seed_of(815));
    for (std::size_t i = 0; i < case_count(3'000); ++i) {
        const ShapeKind kind = std::array{ShapeKind::sphere, ShapeKind::capsule, ShapeKind::cylinder}[i % 3];
        std::vector<Point3> none;
        const Vec3 centre = in_cube(random, 20.0F);
        const geometry::Shape shape = any_shape(random, kind, centre, 20.0F, none);
        const Vec3 half(random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F));
        const float angle = random.uniform(0.0F, 6.28F);
        const Vec3 out = std::cos(angle) * shape.axes.col(0) + std::sin(angle) * shape.axes.col(1);
        const float clearance = random.uniform(0.0F, 2.0F);
        const Vec3 place = centre +
                           (shape.radius + half.dot(out.cwiseAbs()) + clearance + random.uniform(0.02F, 3.0F)) * out +
                           random.uniform(-0.95F, 0.95F) * shape.half.z() * shape.axes.col(2);
        ASSERT_TRUE(detail::Planes(shape, shape.centre).part(place, place, half, clearance)) << i;
    }
}

/// Deep overlap with a solid is detected if the sphere in the box or the box's corner shows it.
TEST(PlanesLaw, WhatIsInASolidByFarIsSeenToBe)
{
    const Vec3 half = Vec3::Constant(0.5F);
    const auto touches = [](const geometry::Shape& shape, const Vec3& at, const Vec3& own, float clearance) {
        return detail::Planes(shape, shape.centre).touch(at, own, clearance);
    };
    // Before the middle of a wall, within the clearance: no corner is in it.
    const geometry::Shape wall = geometry::make_box(Vec3::Zero(), Vec3(0.5F, 20.0F, 20.0F));
    const geometry::Shape mast = geometry::make_cylinder(Vec3(0.0F, 0.0F, -20.0F), Vec3(0.0F, 0.0F, 20.0F), 0.5F);
    const geometry::Shape drum = geometry::make_cylinder(Vec3(0.0F, 0.0F, -0.5F), Vec3(0.0F, 0.0F, 0.5F), 20.0F);
    const geometry::Shape pole = geometry::make_capsule(Vec3(0.0F, 0.0F, -20.0F), Vec3(0.0F, 0.0F, 20.0F), 2.0F);
    for (const float side : {-1.0F, 1.0F}) {
        EXPECT_TRUE(touches(wall, Vec3(side * 1.9F, 3.0F, 4.0F), half, 1.0F));
        EXPECT_FALSE(touches(wall, Vec3(side * 2.1F, 3.0F, 4.0F), half, 1.0F));
        // Beside the middle of a mast, above a drum's, above a pole's round end: likewise.
        EXPECT_TRUE(touches(mast, Vec3(0.0F, side * 1.9F, 3.0F), half, 1.0F));
        EXPECT_FALSE(touches(mast, Vec3(0.0F, side * 2.1F, 3.0F), half, 1.0F));
        EXPECT_TRUE(touches(drum, Vec3(3.0F, 2.0F, side * 1.9F), half, 1.0F));
        EXPECT_FALSE(touches(drum, Vec3(3.0F, 2.0F, side * 2.1F), half, 1.0F));
        EXPECT_TRUE(touches(pole, Vec3(0.0F, 0.0F, side * 22.4F), half, 0.0F));
        EXPECT_FALSE(touches(pole, Vec3(0.0F, 0.0F, side * 22.6F), half, 0.0F));
        // A box with long arms: an arm reaches into the wall, the sphere in the box does not.
        EXPECT_TRUE(touches(wall, Vec3(side * 4.0F, 3.0F, 4.0F), Vec3(4.0F, 0.1F, 0.1F), 0.0F));
        EXPECT_FALSE(touches(wall, Vec3(side * 4.6F, 3.0F, 4.0F), Vec3(4.0F, 0.1F, 0.1F), 0.0F));
    }
}

/// Paths past a box's edge between two faces are left to a search, which costs as much as planes across all edges.
TEST(PlanesLaw, ABoxIsPartedByItsFacesAlone)
{
    const Mat3 turned = Eigen::AngleAxisf(0.25F * 3.14159265F, Vec3::UnitZ()).toRotationMatrix();
    const detail::Planes on_edge(geometry::make_box(Vec3::Zero(), Vec3::Ones(), turned), Vec3::Zero());
    const detail::Planes on_face(geometry::make_box(Vec3::Zero(), Vec3::Ones()), Vec3::Zero());
    const Vec3 half = Vec3::Constant(0.5F);
    EXPECT_FALSE(on_edge.part(Vec3(-0.2F, 2.0F, 0.0F), Vec3(0.2F, 2.0F, 0.0F), half, 0.0F));
    EXPECT_TRUE(on_edge.part(Vec3(1.0F, 2.0F, 0.0F), Vec3(1.2F, 2.0F, 0.0F), half, 0.0F)) << "beyond one face";
    EXPECT_TRUE(on_face.part(Vec3(-0.2F, 2.0F, 0.0F), Vec3(0.2F, 2.0F, 0.0F), half, 0.0F));
}

/// Solids and boxes of zero size, so that only the rounding allowance remains, to the bit: up to it no decision,
/// slightly beyond it a decision.
TEST(PlanesLaw, AtTheRoomLeftForRoundingNothingIsReported)
{
    const Vec3 zero = Vec3::Zero();
    const auto next = [](float x) { return std::nextafter(x, 1.0F); };
    // A share of 1 m and of both ends' distances.
    float room = detail::kExtentRounding;
    for (int i = 0; i < 4; ++i) {
        room = detail::kExtentRounding * (1.0F + room + room);
    }
    for (const geometry::Shape& shape : {geometry::make_box(zero, zero), geometry::make_sphere(zero, 0.0F),
                                         geometry::make_cylinder(zero, zero, 0.0F)}) {
        const detail::Planes planes(shape, zero);
        const auto part = [&](float at) { return planes.part(Vec3(0.0F, 0.0F, at), Vec3(0.0F, 0.0F, at), zero, 0.0F); };
        EXPECT_FALSE(part(room)) << int(shape.kind);
        EXPECT_TRUE(part(next(room))) << int(shape.kind);
        if (shape.kind != ShapeKind::sphere) {
            const auto part_all = [&](float at) {
                const detail::Curve curve = curve_of(Vec3(0.0F, 0.0F, at), Vec3(0.0F, 0.0F, at));
                return planes.part(detail::view_of(curve), zero, 0.0F);
            };
            EXPECT_FALSE(part_all(room)) << int(shape.kind);
            EXPECT_TRUE(part_all(next(room))) << int(shape.kind);
        }
        const auto touch = [&](float half) { return planes.touch(zero, Vec3::Constant(half), 0.0F); };
        EXPECT_FALSE(touch(detail::kExtentRounding)) << int(shape.kind);
        EXPECT_TRUE(touch(next(detail::kExtentRounding))) << int(shape.kind);
    }
    // A corner that is inside by just that much, the sphere in its box by less.
    const float size = 1.5F * detail::kExtentRounding;
    const geometry::Shape box = geometry::make_box(zero, Vec3::Constant(size));
    const float corner = size - detail::kExtentRounding * (1.0F + geometry::bounding_radius(box));
    EXPECT_FALSE(detail::Planes(box, zero).touch(zero, Vec3::Constant(corner), 0.0F));
    EXPECT_TRUE(detail::Planes(box, zero).touch(zero, Vec3::Constant(0.9999F * corner), 0.0F));
}

}  // namespace
}  // namespace jink::geometric
