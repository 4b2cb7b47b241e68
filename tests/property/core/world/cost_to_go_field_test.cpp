// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/cost_to_go_field.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "tests/numbers.hpp"
#include "tests/property/core/world/cost_to_go_oracle.hpp"
#include "tests/unit/core/world/field_scene.hpp"

namespace jink::world {
namespace {

using geometry::oracle::any_rotation;
using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using oracle::CellIndex;
using oracle::CostToGoOracle;
using oracle::Mark;
using oracle::Vec3d;
using test::field_of;
using test::Scene;

constexpr double kAccuracy = 1e-3;  ///< of costs [s]

/// Places of cells are exact in float: the vehicle is at a multiple of 0.25 m.
float quarter(float value) { return 0.25F * std::round(4.0F * value); }

geometry::Shape any_solid(Random& random, const Vec3& at)
{
    const float size = random.uniform(0.3F, 8.0F);
    const Vec3 arm = in_cube(random, size);
    switch (random.below(7)) {
    case 0: return geometry::make_sphere(at, size);
    case 1: return geometry::make_capsule(at - size * Vec3::UnitZ(), at + size * Vec3::UnitZ(), 0.3F * size);
    case 2: return geometry::make_capsule(at - arm, at + arm, 0.3F * size);
    case 3: return geometry::make_cylinder(at - arm, at + arm, 0.5F * size);
    case 4: return geometry::make_box(at, in_cube(random, size).cwiseAbs(), any_rotation(random));
    default:
        return geometry::make_box(at, Vec3(random.uniform(0.2F, 10.0F), random.uniform(0.2F, 6.0F), 12.0F),
                                  Eigen::AngleAxisf(random.uniform(-kPi, kPi), Vec3::UnitZ()).toRotationMatrix());
    }
}

/// The vehicle on a bent route among solids and closed areas, within bounds. Do not copy.
struct RandomScene : Scene {
    path::Route route;

    explicit RandomScene(Random& random)
    {
        own.position = Vec3(quarter(random.uniform(-80.0F, 80.0F)), quarter(random.uniform(-80.0F, 80.0F)),
                            quarter(random.uniform(20.0F, 60.0F)));
        own.sigma_position = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.3F);
        limits.half_extents = Vec3(random.uniform(0.2F, 1.5F), random.uniform(0.2F, 1.5F), random.uniform(0.1F, 1.0F));
        limits.max_climb = random.uniform(0.3F, 6.0F);
        limits.max_descent = random.uniform(0.3F, 6.0F);
        const float heading = random.uniform(-kPi, kPi);
        const Vec3 along(std::cos(heading), std::sin(heading), 0.0F);
        const Vec3 start = own.position - random.uniform(0.0F, 15.0F) * along + in_cube(random, 3.0F);
        const Vec3 corner = start + random.uniform(5.0F, 60.0F) * along;
        EXPECT_EQ(route.add_leg(start, corner), path::RouteStatus::ok);
        if (random.below(3) != 0) {
            const Vec3 end = corner + in_cube(random, 60.0F).cwiseProduct(Vec3(1.0F, 1.0F, 0.15F));
            static_cast<void>(route.add_leg(corner, end));
        }
        reference = Reference(route, random.uniform(0.5F, 10.0F));
        for (std::uint64_t i = 0, n = 1 + random.below(9); i < n; ++i) {
            const Vec3 at = own.position + in_cube(random, 30.0F).cwiseProduct(Vec3(1.0F, 1.0F, 0.3F));
            obstacle(any_solid(random, at));
            obstacles.back().uncertainty = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.0F);
        }
        if (random.below(3) == 0) {
            const Vec3 at = own.position + in_cube(random, 30.0F);
            Cylinder& area = cylinder(at.head<2>(), random.uniform(1.0F, 12.0F));
            area.bottom = at.z() - random.uniform(0.0F, 20.0F);
            area.top = at.z() + random.uniform(0.0F, 20.0F);
            area.margin = random.uniform(0.0F, 2.0F);
        }
        airspace.has_floor = random.below(2) == 0;
        airspace.floor = own.position.z() - random.uniform(-1.0F, 15.0F);
        airspace.has_ceiling = random.below(2) == 0;
        airspace.ceiling = own.position.z() + random.uniform(-1.0F, 15.0F);
        airspace.has_keep_in = random.below(3) == 0;
        airspace.home = own.position + in_cube(random, 20.0F);
        airspace.keep_in_radius = random.uniform(15.0F, 60.0F);
    }
};

Vec3 any_place(Random& random, const Scene& scene)
{
    return scene.own.position + in_cube(random, 34.0F).cwiseProduct(Vec3(1.0F, 1.0F, 0.4F));
}

template <class Vector>
std::string text(const Vector& v)
{
    return "(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + ")";
}

template <class T>
bool same_bits(const std::optional<T>& a, const std::optional<T>& b)
{
    return a.has_value() == b.has_value() && (!a || std::memcmp(&*a, &*b, sizeof(T)) == 0);
}

/// What a field answers at places about a scene; the same places for the same seed.
struct Answers {
    std::vector<std::optional<Seconds>> lost;
    std::vector<std::optional<Vec3>> around;

    Answers(const CostToGoField& field, const Scene& scene, std::uint64_t seed, int count = 200)
    {
        Random random(seed);
        for (int i = 0; i < count; ++i) {
            const Vec3 place = any_place(random, scene);
            lost.push_back(field.lost_from(place));
            around.push_back(field.way_around(place, random.uniform(0.0F, 12.0F)));
        }
    }
    bool operator==(const Answers& o) const
    {
        return std::equal(lost.begin(), lost.end(), o.lost.begin(), o.lost.end(), same_bits<Seconds>) &&
               std::equal(around.begin(), around.end(), o.around.begin(), o.around.end(), same_bits<Vec3>);
    }
    [[nodiscard]] std::size_t known() const
    {
        return static_cast<std::size_t>(std::count_if(lost.begin(), lost.end(), [](const auto& l) { return !!l; }));
    }
    [[nodiscard]] std::size_t ways() const
    {
        return static_cast<std::size_t>(std::count_if(around.begin(), around.end(), [](const auto& a) { return !!a; }));
    }
};

TEST(CostToGoLaw, IsThatOfDijkstrasAlgorithm)
{
    const std::uint64_t seed = seed_of(20261128);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t exact = 0;
    std::size_t bounded = 0;
    std::size_t lossy = 0;
    std::size_t hopeless = 0;
    double largest = 0.0;
    for (std::size_t n = 0; n < case_count(40); ++n) {
        const RandomScene scene(random);
        const CostToGoOracle truth(scene);
        const auto field = field_of(scene);
        if (!field->lost_from(scene.own.position) || !truth.knows_sources()) {
            continue;
        }
        const auto check = [&](const Vec3& place, const CellIndex& cell) {
            const std::optional<Seconds> lost = field->lost_from(place);
            ASSERT_TRUE(lost) << "case " << n;
            const auto bounds = truth.lost_from(place.cast<double>(), cell);
            ASSERT_GE(double(*lost), bounds[0] - kAccuracy) << "case " << n << " at " << text(place);
            ASSERT_LE(double(*lost), bounds[1] + kAccuracy) << "case " << n << " at " << text(place);
            const bool is_exact = bounds[1] - bounds[0] < kAccuracy;
            (is_exact ? exact : bounded) += 1;
            lossy += is_exact && bounds[1] > 0.1 && bounds[1] < 30.0 ? 1U : 0U;
            hopeless += is_exact && bounds[0] >= 30.0 ? 1U : 0U;
            largest = is_exact ? std::max(largest, std::abs(double(*lost) - bounds[0])) : largest;
        };
        for (std::size_t i = 0; i < CostToGoField::kCells; ++i) {
            const CellIndex cell = CostToGoOracle::cell(i);
            check(truth.middle(cell).cast<float>(), cell);
        }
        for (int i = 0; i < 200; ++i) {
            const CellIndex cell = CostToGoOracle::cell(random.below(CostToGoField::kCells));
            const Vec3 off = in_cube(random, 0.99F).cwiseProduct(Vec3(1.0F, 1.0F, 1.25F));
            const Vec3 place = truth.middle(cell).cast<float>() + off;
            if (field->lost_from(place)) {
                check(place, cell);
            }
        }
        ASSERT_FALSE(HasFatalFailure()) << "case " << n;
    }
    std::printf(
        "[ measured ] %zu places exact, of them %zu lose, %zu without a way; %zu within bounds; off by %.1e s\n", exact,
        lossy, hopeless, bounded, largest);
    EXPECT_GT(exact, 10 * bounded);
    EXPECT_GT(lossy, exact / 50);
    EXPECT_GT(hopeless, exact / 1000);
}

/// From any place step by step: it takes no longer than was said, it ends where nothing is lost, in no blocked cell.
TEST(CostToGoLaw, TheWayAroundLeadsOutAndIsTheQuickest)
{
    const std::uint64_t seed = seed_of(20261129);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t ways = 0;
    double most_longer = 0.0;
    for (std::size_t n = 0; n < case_count(40); ++n) {
        const RandomScene scene(random);
        const CostToGoOracle truth(scene);
        const auto field = field_of(scene);
        for (int i = 0; i < 300; ++i) {
            const CellIndex start = CostToGoOracle::cell(random.below(CostToGoField::kCells));
            if (truth.mark_of(start) != Mark::free) {
                continue;
            }
            Vec3 at = truth.middle(start).cast<float>();
            // One step of cells each, or longer ones.
            const float distance = random.below(2) == 0 ? 1.0F : random.uniform(2.0F, 10.0F);
            const std::optional<Seconds> first = field->lost_from(at);
            double spent = 0.0;
            std::size_t turns = 0;
            for (std::optional<Vec3> next = field->way_around(at, distance); next;
                 next = field->way_around(at, distance)) {
                spent += truth.time_of((*next - at).cast<double>());
                ASSERT_NE(*next, at) << "case " << n;
                at = *next;
                const Vec3 in = at - truth.middle({}).cast<float>();
                const CellIndex cell{static_cast<int>(std::lround(in.x() / 2.0F)),
                                     static_cast<int>(std::lround(in.y() / 2.0F)),
                                     static_cast<int>(std::lround(in.z() / 2.5F))};
                ASSERT_TRUE(CostToGoOracle::is_in(cell)) << "case " << n;
                ASSERT_NE(truth.mark_of(cell), Mark::blocked) << "case " << n << " at " << text(at);
                ASSERT_LT(++turns, 300U) << "case " << n;
            }
            if (turns > 0) {
                ++ways;
                ASSERT_LE(*field->lost_from(at), 0.1F) << "case " << n;
                const double left = truth.straight(at.cast<double>()) - truth.straight(truth.middle(start));
                const double longer = spent + left + double(*field->lost_from(at)) - double(*first);
                most_longer = std::max(most_longer, longer);
                ASSERT_LE(longer, 0.01) << "case " << n << " from " << text(truth.middle(start));
            } else if (first && *first > 0.1F) {
                ASSERT_EQ(*first, CostToGoField::kNoWay) << "case " << n;
            }
        }
    }
    std::printf("[ measured ] %zu ways, %.1e s longer at most\n", ways, most_longer);
    EXPECT_GT(ways, case_count(40) * 10);
}

TEST(CostToGoLaw, IsTheSameHoweverTheWorkIsDivided)
{
    const std::uint64_t seed = seed_of(20261130);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t known = 0;
    std::size_t ways = 0;
    for (std::size_t n = 0; n < case_count(60); ++n) {
        const RandomScene scene(random);
        const auto whole = field_of(scene);
        // One that has built another scene before.
        const RandomScene other(random);
        const auto pieces = field_of(other);
        pieces->begin(scene.situation());
        const bool is_tight = random.below(2) == 0;
        for (int i = 0; !pieces->is_idle(); ++i) {
            ASSERT_LT(i, 20000) << "case " << n;
            const std::uint32_t more = is_tight ? 0U : static_cast<std::uint32_t>(random.below(20000));
            WorkBudget budget(CostToGoField::kPiece + more);
            const Progress progress = pieces->advance(budget);
            ASSERT_NE(progress, Progress::failed);
            ASSERT_FALSE(budget.exhausted()) << "it takes what it does not use";
            if (progress == Progress::done) {
                pieces->show();
            }
        }
        const Answers expected(*whole, scene, n);
        ASSERT_EQ(Answers(*pieces, scene, n), expected) << "case " << n;
        known += expected.known();
        ways += expected.ways();
    }
    EXPECT_GT(known, case_count(60) * 50);
    EXPECT_GT(ways, case_count(60) * 5);
}

TEST(CostToGoLaw, TheShownFieldDoesNotChangeWhileTheNextIsBuilt)
{
    const std::uint64_t seed = seed_of(20261201);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t n = 0; n < case_count(8); ++n) {
        const RandomScene first(random);
        const RandomScene second(random);
        const RandomScene third(random);
        const auto field = field_of(first);
        const Answers shown(*field, first, n, 30);
        field->begin(second.situation());
        ASSERT_EQ(Answers(*field, first, n, 30), shown) << "case " << n;
        // Given up somewhere on the way for the third.
        const std::uint64_t given_up = random.below(120);
        for (std::uint64_t i = 0;; ++i) {
            if (i == given_up) {
                field->begin(third.situation());
            }
            WorkBudget budget(CostToGoField::kPiece);
            const Progress progress = field->advance(budget);
            ASSERT_EQ(Answers(*field, first, n, 30), shown) << "case " << n << ", piece " << i;
            if (progress == Progress::done && i > given_up) {
                break;
            }
            if (progress == Progress::running) {
                field->show();
                ASSERT_EQ(Answers(*field, first, n, 30), shown) << "case " << n << ": nothing is complete";
            }
        }
        field->show();
        ASSERT_TRUE(field->is_idle());
        ASSERT_EQ(Answers(*field, third, n), Answers(*field_of(third), third, n)) << "case " << n;
    }
}

TEST(CostToGoLaw, AnswersAreInTheirRangeEverywhere)
{
    const std::uint64_t seed = seed_of(20261202);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t known = 0;
    for (std::size_t n = 0; n < case_count(60); ++n) {
        const RandomScene scene(random);
        const auto field = field_of(scene);
        const Vec3 half(32.0F, 32.0F, 12.5F);
        for (int i = 0; i < 400; ++i) {
            Vec3 off = in_cube(random, 1.1F).cwiseProduct(half);
            if (random.below(3) == 0) {
                const auto axis = static_cast<int>(random.below(3));
                constexpr float kEdges[] = {-1.0F, 1.0F, -1.00001F, 1.00001F, 1e9F, kNan, kInfinity, -kInfinity};
                off[axis] = kEdges[random.below(8)] * half[axis];
            }
            const Vec3 place = scene.own.position + off;
            constexpr float kDistances[] = {0.0F, -1.0F, 5.0F, 1e9F, kNan, kInfinity};
            const std::optional<Seconds> lost = field->lost_from(place);
            const std::optional<Vec3> around = field->way_around(place, kDistances[random.below(6)]);
            const bool is_out = !(off.cwiseAbs().array() <= half.array() + 1e-3F).all();
            ASSERT_FALSE(is_out && lost) << "case " << n << " at " << text(place);
            ASSERT_FALSE(around && !lost) << "case " << n << " at " << text(place);
            if (lost) {
                ++known;
                ASSERT_TRUE(*lost >= 0.0F && *lost <= CostToGoField::kNoWay) << "case " << n << ": " << *lost;
            }
            if (around) {
                const Vec3 from_own = *around - scene.own.position;
                ASSERT_TRUE((from_own.cwiseAbs().array() <= half.array() + 1e-3F).all()) << "case " << n;
            }
        }
    }
    EXPECT_GT(known, case_count(60) * 100);
}

/// Obstacles that leave the corridor to the goal free cost nothing there, and the way goes straight on.
TEST(CostToGoLaw, NothingIsLostWhereNothingIsInTheWay)
{
    const std::uint64_t seed = seed_of(20261203);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t known = 0;
    for (std::size_t n = 0; n < case_count(60); ++n) {
        Scene scene;
        scene.own.position = in_cube(random, 50.0F);
        const float heading = random.uniform(-kPi, kPi);
        const Vec3 along(std::cos(heading), std::sin(heading), 0.0F);
        const Vec3 left(-along.y(), along.x(), 0.0F);
        // Level, climbing, straight up or down; beside the vehicle by up to 1 m.
        const Vec3 climb = random.uniform(-1.0F, 1.0F) * Vec3::UnitZ();
        const Vec3 to = random.below(4) == 0 ? Vec3(climb + 0.01F * along) : Vec3(along + climb);
        const Vec3 start = scene.own.position + in_cube(random, 1.0F);
        scene.leg(start, start + random.uniform(10.0F, 150.0F) * to.normalized(), random.uniform(1.0F, 10.0F));
        for (std::uint64_t i = 0, count = 1 + random.below(4); i < count; ++i) {
            // Behind the vehicle.
            const Vec3 at = scene.own.position - random.uniform(16.0F, 30.0F) * along +
                            random.uniform(-20.0F, 20.0F) * left + random.uniform(-8.0F, 8.0F) * Vec3::UnitZ();
            scene.obstacle(geometry::make_sphere(at, random.uniform(0.2F, 8.0F)));
        }
        const auto field = field_of(scene);
        for (float ahead = 0.0F; ahead < 8.0F; ahead += 0.7F) {
            const Vec3 place = scene.own.position + ahead * to.normalized() + in_cube(random, 1.0F);
            const std::optional<Seconds> lost = field->lost_from(place);
            known += lost ? 1U : 0U;
            ASSERT_LE(lost.value_or(0.0F), float(kAccuracy)) << "case " << n;
            ASSERT_FALSE(field->way_around(place, 6.0F)) << "case " << n;
        }
    }
    EXPECT_GT(known, case_count(60) * 5);
}

}  // namespace
}  // namespace jink::world
