// SPDX-License-Identifier: BSD-3-Clause
// Looks at planes: never "apart" of what touches, never "touches" of what is clear, against least-norm points in
// double; and most of what they are there for is seen.
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
    unsigned clear = 0, parted = 0;  ///< farther than the clearance, and told so
    unsigned near = 0, touched = 0;  ///< a box at rest well within the clearance, and told so
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

TEST(PlanesLaw, NothingIsToldThatIsNotSo)
{
    Random random(seed_of(811));
    std::array<Seen, kKinds.size()> seen{};
    const std::size_t count = case_count(20'000);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = i % kKinds.size();
        std::vector<Vec3> vertices;
        const Vec3 centre = in_cube(random, 40.0F);
        const geometry::Shape shape = any_shape(random, kKinds[k], centre, random.uniform(0.2F, 12.0F), vertices);
        const Vec3 half(random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F));
        const Vec3 a = centre + in_cube(random, random.below(2) == 0 ? 8.0F : 25.0F);
        const Vec3 b = random.below(3) == 0 ? Vec3(a + in_cube(random, 0.5F)) : Vec3(centre + in_cube(random, 25.0F));
        const detail::Planes planes(shape, shape.centre);
        const auto way = geometry::oracle::swept_box_bounds(half, a, b, shape, 1e-7);
        // About what they are apart, or none, or anything.
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

/// Faces that lie on one another but for a hair: whatever is told lies on the safe side of rounding.
TEST(PlanesLaw, AHairIsNeverTakenForRoom)
{
    Random random(seed_of(812));
    unsigned told = 0;
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
        told += parted ? 1U : 0U;
        ASSERT_TRUE(!parted || gap > 0.0) << i << ": " << gap;
        const detail::Curve curve = curve_of(a, b);
        const bool all = planes.part(detail::view_of(curve), half, 0.0F);
        ASSERT_TRUE(!all || gap > 0.0) << i << ": " << gap;
        // At rest: within this clearance it touches, beyond it it does not.
        const bool touched = planes.touch(a, half, 0.0F);
        ASSERT_TRUE(!touched || gap < 0.0) << i << ": " << gap;
    }
    EXPECT_GT(told, case_count(20'000) / 4) << "a hair that rounding cannot reach is seen";
}

}  // namespace
}  // namespace jink::geometric
