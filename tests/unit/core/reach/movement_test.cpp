// SPDX-License-Identifier: BSD-3-Clause
// Kinematics of the movements: the derived figures of the reach-set specification, section 16.1.
#include "core/reach/movement.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/reach/grid.hpp"

namespace jink::reach {
namespace {

constexpr double kMovementDegree = 0.017453292519943295;
constexpr auto S = Movement::straight;
constexpr auto L = Movement::left;
constexpr auto R = Movement::right;
constexpr auto U = Movement::up;
constexpr auto UL = Movement::up_left;

template <class T>
Pose<T> fly(const std::vector<Movement>& movements, const Pose<T>& from = {},
            DisplacementModel model = DisplacementModel::arc)
{
    Pose<T> pose = from;
    for (const Movement movement : movements) {
        pose = apply(pose, movement, MovementStep<T>{}, model);
    }
    return pose;
}

TEST(Movements, EndWhereTheReferenceResultsSay)
{
    struct Case {
        std::vector<Movement> movements;
        double x, y, z, pitch, yaw, distance, horizontal, vertical;
    };
    const std::vector<Case> cases{
        {{S}, 1.0, 0.0, 0.0, 0, 0, 1.0, 0.0, 0.0},
        {{L}, 0.988616, 0.130154, 0.0, 0, 15, 0.997147, 7.5, 0.0},
        {{U}, 0.988616, 0.0, 0.130154, -15, 0, 0.997147, 0.0, 7.5},
        {{UL}, 0.977465, 0.127936, 0.130154, -15, 15, 0.994357, 7.4568, 7.5212},
        {{L, L}, 1.909859, 0.511745, 0.0, 0, 30, 1.977232, 15.0, 0.0},
        {{L, R}, 1.977232, 0.260308, 0.0, 0, 0, 1.994293, 7.5, 0.0},
        {{U, L}, 1.943546, 0.125719, 0.388973, -15, 15, 1.986070, 3.7010, 11.2944},
        {{UL, UL}, 1.826993, 0.477465, 0.511745, -30, 30, 1.956466, 14.6461, 15.1630},
        {{L, L, R, S}, 3.797029, 1.152156, 0.0, 0, 15, 3.967983, 16.8797, 0.0},
        {{L, L, L, L, L, L}, 3.819719, 3.819719, 0.0, 0, 90, 5.401898, 45.0, 0.0},
        {{UL, S, S, S, S, S, S, S, S, S}, 9.374579, 2.377936, 2.459525, -15, 15, 9.979308, 14.2333, 14.2683},
        {{S, S, S, S, S, S, S, S, S, S}, 10.0, 0.0, 0.0, 0, 0, 10.0, 0.0, 0.0},
    };
    for (const Case& c : cases) {
        const Pose<double> end = fly<double>(c.movements);
        EXPECT_NEAR(end.position.x(), c.x, 1e-6);
        EXPECT_NEAR(end.position.y(), c.y, 1e-6);
        EXPECT_NEAR(end.position.z(), c.z, 1e-6);
        EXPECT_NEAR(end.pitch, c.pitch * kMovementDegree, 1e-9);
        EXPECT_NEAR(end.yaw, c.yaw * kMovementDegree, 1e-9);
        const Polar<double> polar = to_polar(end.position);
        EXPECT_NEAR(polar.distance, c.distance, 1e-6);
        EXPECT_NEAR(polar.horizontal / kMovementDegree, c.horizontal, 5e-5);
        EXPECT_NEAR(polar.vertical / kMovementDegree, c.vertical, 5e-5);
        const Pose<float> single = fly<float>(c.movements);
        EXPECT_NEAR((single.position.cast<double>() - end.position).norm(), 0.0, 4e-6);
    }
}

/// Section 16.1: six turns to the left end exactly on the grid's border, which is inside; ten movements straight on in
/// the middle of the last layer.
TEST(Movements, EndInTheCellsOfTheReferenceResults)
{
    const Grid<double> grid;
    const Located side = grid.locate(fly<double>({L, L, L, L, L, L}).position);
    EXPECT_EQ(side.status, LocateStatus::inside);
    EXPECT_EQ(side.place.column, 6);
    const Located end = grid.locate(fly<double>(std::vector<Movement>(10, S)).position);
    EXPECT_EQ(end.status, LocateStatus::inside);
    EXPECT_EQ(end.place, (CellPlace{9, 3, 2}));
    const Grid<float> single;
    EXPECT_EQ(single.locate(fly<float>({L, L, L, L, L, L}).position).place.column, 6);
    EXPECT_EQ(single.locate(fly<float>(std::vector<Movement>(10, S)).position).place, (CellPlace{9, 3, 2}));
}

/// Section 3: against 20 000 steps of numerical integration the published figure was within 2e-9.
TEST(Movements, AgreeWithTheFigureOfTheClosedForm)
{
    Pose<double> from;
    from.pitch = 0.2;
    from.yaw = -0.3;
    const Point<double> by =
        arc_displacement(1.0, from.pitch, from.yaw, 15.0 * kMovementDegree, 15.0 * kMovementDegree);
    EXPECT_NEAR(by.x(), 0.9266430943, 1e-9);
    EXPECT_NEAR(by.y(), -0.1600825478, 1e-9);
    EXPECT_NEAR(by.z(), -0.3239670116, 1e-9);
}

/// Table 6.1 as corrected: signs and sizes of all nine.
TEST(Movements, AreThoseOfTheCorrectedTable)
{
    struct Row {
        Movement movement;
        double x, y, z, pitch, yaw;
    };
    const Row rows[] = {{S, 1.0, 0.0, 0.0, 0, 0},
                        {Movement::down, 0.988616, 0.0, -0.130154, 15, 0},
                        {U, 0.988616, 0.0, 0.130154, -15, 0},
                        {L, 0.988616, 0.130154, 0.0, 0, 15},
                        {R, 0.988616, -0.130154, 0.0, 0, -15},
                        {Movement::down_left, 0.977465, 0.127936, -0.130154, 15, 15},
                        {Movement::down_right, 0.977465, -0.127936, -0.130154, 15, -15},
                        {UL, 0.977465, 0.127936, 0.130154, -15, 15},
                        {Movement::up_right, 0.977465, -0.127936, 0.130154, -15, -15}};
    for (const Row& row : rows) {
        const Pose<double> end = fly<double>({row.movement});
        EXPECT_NEAR(end.position.x(), row.x, 1e-6);
        EXPECT_NEAR(end.position.y(), row.y, 1e-6);
        EXPECT_NEAR(end.position.z(), row.z, 1e-6);
        EXPECT_NEAR(end.pitch, row.pitch * kMovementDegree, 1e-12);
        EXPECT_NEAR(end.yaw, row.yaw * kMovementDegree, 1e-12);
    }
}

/// Section 5.2: the other reading of Gomola jumps to the end's heading.
TEST(Movements, WithEndHeadingAreStraight)
{
    const Pose<double> left = fly<double>({L}, {}, DisplacementModel::end_heading);
    EXPECT_NEAR(left.position.x(), 0.965926, 1e-6);
    EXPECT_NEAR(left.position.y(), 0.258819, 1e-6);
    EXPECT_NEAR(left.position.norm(), 1.0, 1e-12);
}

TEST(Movements, AShareOfOneLiesOnIt)
{
    const Pose<double> half = at_share(Pose<double>{}, UL, 0.5, MovementStep<double>{});
    EXPECT_NEAR(half.yaw, 7.5 * kMovementDegree, 1e-12);
    // The second half, from there, leads to the same end: half as long, half the turn.
    const MovementStep<double> rest{0.5, 7.5 * kMovementDegree, 7.5 * kMovementDegree};
    const Pose<double> end = apply(half, UL, rest);
    const Pose<double> whole = fly<double>({UL});
    EXPECT_NEAR((end.position - whole.position).norm(), 0.0, 1e-12);
    EXPECT_NEAR(end.pitch, whole.pitch, 1e-12);
}

TEST(Movements, WithEndHeadingClimbWhereTheirEndPoints)
{
    Pose<double> from;
    from.position = Point<double>(1, 2, 3);
    from.pitch = 10.0 * kMovementDegree;
    from.yaw = 90.0 * kMovementDegree;
    const auto end = [&](Movement movement, double share) {
        return at_share(from, movement, share, MovementStep<double>{}, DisplacementModel::end_heading);
    };
    const Pose<double> down = end(Movement::down, 1.0);
    EXPECT_NEAR(down.pitch, 25.0 * kMovementDegree, 1e-12);
    EXPECT_NEAR(down.position.z(), 3.0 - std::sin(25.0 * kMovementDegree), 1e-12);
    EXPECT_NEAR(down.position.y(), 2.0 + std::cos(25.0 * kMovementDegree), 1e-12);
    const Pose<double> up = end(U, 0.5);
    EXPECT_NEAR(up.pitch, -5.0 * kMovementDegree, 1e-12);
    EXPECT_NEAR(up.position.z(), 3.0 + 0.5 * std::sin(5.0 * kMovementDegree), 1e-12);
    const Pose<double> left = end(L, 1.0);
    EXPECT_NEAR(left.yaw, 105.0 * kMovementDegree, 1e-12);
    EXPECT_NEAR(left.position.x(), 1.0 - std::cos(10.0 * kMovementDegree) * std::sin(15.0 * kMovementDegree), 1e-12);
}

TEST(Movements, StraightFlightAloneIsSmooth)
{
    for (const Movement movement : kAllMovements) {
        EXPECT_EQ(is_smooth(movement), movement == S);
    }
}

}  // namespace
}  // namespace jink::reach
