// SPDX-License-Identifier: BSD-3-Clause
// Solids in exact contact, and scenes that differ by a power of two alone. All coordinates are multiples of 1/64 of
// moderate size, so that their sums are exact. Faces in one plane are so without rounding, and the result must not
// depend on rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/random.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::geometry {
namespace {

/// A multiple of 1/64 in [-most, most].
float exact(Random& random, int most)
{
    const auto steps = static_cast<std::uint64_t>(64 * most);
    return (static_cast<float>(random.below(2 * steps + 1)) - static_cast<float>(steps)) / 64.0F;
}

Vec3 exact_vector(Random& random, int most) { return {exact(random, most), exact(random, most), exact(random, most)}; }

struct Scene {
    Vec3 half;
    Vec3 from;
    Vec3 to;
    Vec3 point;  ///< on the surface of the swept box
    int axis;    ///< of the face that it lies on
    float side;  ///< of that face
};

/// A box swept along a path, short, long or of zero length, and a point on it: on a face, an edge or a corner.
Scene any_scene(std::uint64_t seed)
{
    Random random(seed);
    Scene scene;
    scene.half = exact_vector(random, 3).cwiseAbs();
    scene.from = exact_vector(random, 8);
    const int way = static_cast<int>(random.below(4));
    scene.to = way == 0 ? scene.from : Vec3(scene.from + exact_vector(random, way == 1 ? 1 : 60));
    scene.axis = static_cast<int>(random.below(3));
    if (random.below(4) == 0) {  // a line along which all of it lies
        const Vec3 only = Vec3::Unit(scene.axis);
        scene.half = scene.half.cwiseProduct(only);
        scene.to = scene.from + (scene.to - scene.from).cwiseProduct(only);
    }
    scene.side = random.below(2) == 0 ? -1.0F : 1.0F;
    const Vec3 end = scene.side * (scene.to - scene.from)[scene.axis] >= 0.0F ? scene.to : scene.from;
    for (int i = 0; i < 3; ++i) {
        const float share = static_cast<float>(random.below(3)) - 1.0F;
        const float inside = random.below(2) == 0 ? share : 0.5F * share;
        scene.point[i] = end[i] + inside * scene.half[i];
    }
    scene.point[scene.axis] = end[scene.axis] + scene.side * scene.half[scene.axis];
    return scene;
}

/// One of each kind, all of extent `size` from their centre towards the box of the scene; the nearest point of each is
/// a face, a corner or a side, and lies at the scene's point moved off by `gap`.
std::array<Shape, 6> at_point(const Scene& scene, float size, float gap, std::array<Point3, 4>& vertices)
{
    const Vec3 out = scene.side * Vec3::Unit(scene.axis);
    const Vec3 across = Vec3::Unit((scene.axis + 1) % 3);
    const Vec3 centre = scene.point + (gap + size) * out;
    vertices = {Point3::of(-size * out), Point3::of(size * out + size * across), Point3::of(size * out - size * across),
                Point3::of(size * out + size * Vec3::Unit((scene.axis + 2) % 3))};
    const Vec3 half = 0.5F * size * (Vec3::Ones() + Vec3::Unit(scene.axis));
    return {make_sphere(centre, size),
            make_box(centre, half),
            make_capsule(centre - size * across, centre + size * across, size),
            make_cylinder(centre - size * across, centre + size * across, size),
            make_cylinder(centre - size * out, centre + size * out, size),
            make_hull(vertices, centre)};
}

constexpr std::array kSizes{0.0F, 0.25F, 1.5F};

TEST(Touching, IsContactForEverySolidAtEveryPlace)
{
    for (std::uint64_t seed = 1; seed <= 4'000; ++seed) {
        const Scene scene = any_scene(seed);
        const float size = kSizes[seed % kSizes.size()];
        const float gap = seed % 2 == 0 ? 0.0F : 2.0F * size;
        std::array<Point3, 4> vertices;
        for (const Shape& shape : at_point(scene, size, gap, vertices)) {
            WorkBudget budget(2 * kUnitsPerQuery);
            ASSERT_EQ(swept_box_contact(scene.half, scene.from, scene.to, shape, gap, budget), Contact::contact)
                << "seed " << seed << " kind " << int(shape.kind);
            ASSERT_LE(swept_box_distance(scene.half, scene.from, scene.to, shape, 100.0F, 0.0F, budget), gap)
                << "seed " << seed << " kind " << int(shape.kind);
            ASSERT_FALSE(budget.exhausted());
        }
    }
}

TEST(Touching, OfAPointIsContactForTheClosedForms)
{
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        const Scene scene = any_scene(seed);
        const float radius = kSizes[seed % kSizes.size()];
        const Vec3 centre = scene.point + radius * scene.side * Vec3::Unit(scene.axis);
        // The sphere is static, or moves while the box is static.
        const Motion own{scene.from, scene.to - scene.from};
        const Motion still{centre, Vec3::Zero()};
        ASSERT_TRUE(contact_interval(scene.half, own, still, radius, 1.0F)) << "seed " << seed;
        ASSERT_TRUE(contact_interval(scene.half, {}, {centre - scene.from, scene.from - scene.to}, radius, 1.0F))
            << "seed " << seed;
        ASSERT_NE(quick_reject(scene.half, centre - scene.from, centre - scene.to, radius), QuickReject::apart)
            << "seed " << seed;
        const float size =
            (centre - scene.from).cwiseAbs().sum() + (scene.to - scene.from).cwiseAbs().sum() + scene.half.sum();
        ASSERT_NEAR(least_distance(scene.half, own, still, 1.0F).distance, radius, 5e-7F * size) << "seed " << seed;
        ASSERT_NEAR(swept_distance(scene.half, scene.from, scene.to, centre, centre), radius, 5e-7F * size)
            << "seed " << seed;
    }
}

TEST(Touching, AQuickRejectAtLongWaysPastLargeBoxesIsNotDeceived)
{
    // Along a face, exactly at its radius, with one end of the path much farther out than the other.
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        Random random(seed);
        const auto axis = static_cast<int>(random.below(3));
        const int along = (axis + 1 + static_cast<int>(random.below(2))) % 3;
        Vec3 half = exact_vector(random, 1).cwiseAbs();
        half[along] = std::abs(exact(random, 400));
        const float radius = std::abs(exact(random, 1));
        Vec3 from = Vec3::Zero();
        from[axis] = half[axis] + radius;
        Vec3 to = from;
        from[along] = std::clamp(exact(random, 4), -half[along], half[along]);
        to[along] = from[along] + (random.below(2) == 0 ? 2.0F : 0.0F) * half[along];
        if (random.below(2) == 0) {
            std::swap(from, to);
        }
        ASSERT_NE(quick_reject(half, from, to, radius), QuickReject::apart) << "seed " << seed;
    }
}

TEST(Scale, APowerOfTwoChangesNeitherAnswersNorWork)
{
    for (std::uint64_t seed = 1; seed <= 1'500; ++seed) {
        Random random(seed);
        Scene scene = any_scene(seed);
        const float size = kSizes[1 + seed % 2];
        const float gap = random.below(2) == 0 ? std::abs(exact(random, 1)) : std::abs(exact(random, 20));
        scene.point += 0.25F * exact_vector(random, 1);
        std::array<Point3, 4> vertices;
        const auto shapes = at_point(scene, size, 0.1F * gap, vertices);
        for (const float scale : {0x1p-24F, 0x1p-12F, 0x1p12F}) {
            for (Shape shape : shapes) {
                std::array<Point3, 4> scaled;
                for (std::size_t i = 0; i < vertices.size(); ++i) {
                    scaled[i] = Point3::of(scale * vertices[i].vec());
                }
                WorkBudget budget(2 * kUnitsPerQuery);
                const Contact contact = swept_box_contact(scene.half, scene.from, scene.to, shape, gap, budget);
                const float distance = swept_box_distance(scene.half, scene.from, scene.to, shape, 2.0F, 0.0F, budget);
                shape.centre *= scale;
                shape.radius *= scale;
                shape.half *= scale;
                shape.vertices = shape.vertices.empty() ? shape.vertices : std::span<const Point3>(scaled);
                const Vec3 half = scale * scene.half;
                const Vec3 from = scale * scene.from;
                const Vec3 to = scale * scene.to;
                WorkBudget other(2 * kUnitsPerQuery);
                ASSERT_EQ(swept_box_contact(half, from, to, shape, scale * gap, other), contact) << "seed " << seed;
                ASSERT_EQ(swept_box_distance(half, from, to, shape, scale * 2.0F, 0.0F, other), scale * distance)
                    << "seed " << seed;
                ASSERT_EQ(other.spent(), budget.spent()) << "seed " << seed << " kind " << int(shape.kind);
            }
        }
    }
}

}  // namespace
}  // namespace jink::geometry
