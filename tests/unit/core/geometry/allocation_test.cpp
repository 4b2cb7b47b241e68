// SPDX-License-Identifier: BSD-3-Clause
// No query allocates. The program's own allocation functions count while a test asks them to; libccd allocates by
// realloc.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include "core/base/random.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"

#if !defined(__SANITIZE_ADDRESS__)  // whose own allocator must not be replaced

namespace {
bool counting = false;
std::size_t allocations = 0;

void count() { allocations += counting ? 1 : 0; }
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);

void* malloc(std::size_t size)
{
    count();
    return __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size)
{
    count();
    return __libc_calloc(items, size);
}
void* realloc(void* old, std::size_t size)
{
    count();
    return __libc_realloc(old, size);
}
}

namespace jink::geometry {
namespace {

TEST(Allocation, TheCounterCounts)
{
    counting = true;
    allocations = 0;
    void* volatile some = std::malloc(10);
    void* volatile more = std::realloc(some, 20);
    counting = false;
    std::free(more);
    EXPECT_EQ(allocations, 2U);
}

TEST(Allocation, NoQueryAllocates)
{
    Random random(3);
    const auto any = [&](float side) {
        return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
    };
    float sink = 0.0F;
    counting = true;
    allocations = 0;
    for (int n = 0; n < 1000; ++n) {
        const Vec3 half = any(1.0F).cwiseAbs();
        const Motion own{any(4.0F), any(4.0F)};
        const Motion threat{any(4.0F), any(4.0F)};
        const Vec3 to = own.position + own.velocity;
        sink += contact_interval(half, own, threat, 1.0F, 1.0F) ? 1.0F : 0.0F;
        sink += contact_interval(own, threat, 1.0F, 1.0F) ? 1.0F : 0.0F;
        sink += least_distance(half, own, threat, 1.0F).distance;
        sink += swept_distance(half, own.position, to, threat.position, threat.position + threat.velocity);
        const auto vertex = [&] { return Point3::of(any(1.0F)); };
        const std::array<Point3, 5> vertices{vertex(), vertex(), vertex(), vertex(), vertex()};
        const Vec3 a = any(4.0F);
        const Vec3 b = any(4.0F);
        for (const Shape& shape : {make_sphere(a, 1.0F), make_box(a, any(1.0F).cwiseAbs()), make_capsule(a, b, 1.0F),
                                   make_cylinder(a, b, 1.0F), make_hull(vertices, a)}) {
            WorkBudget budget(1000);
            sink += swept_box_contact(half, own.position, to, shape, 0.1F, budget) == Contact::clear ? 1.0F : 0.0F;
            sink += swept_box_distance(half, own.position, to, shape, 10.0F, 0.01F, budget);
        }
    }
    counting = false;
    EXPECT_EQ(allocations, 0U);
    EXPECT_GT(sink, 0.0F);
}

}  // namespace
}  // namespace jink::geometry

#endif
