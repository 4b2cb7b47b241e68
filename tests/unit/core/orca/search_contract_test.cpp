// SPDX-License-Identifier: BSD-3-Clause
// Guarantees of the search among half-spaces when it cycles, makes little progress, or rounding leaves little of a
// level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tests/unit/core/orca/enumerated.hpp"
#include "tests/unit/core/orca/search_rows.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

using enumerated::unit;

constexpr std::uint32_t kEnough = 10'000'000;

template <class Real>
class SearchContract : public test::SearchRows {
protected:
    SearchContract() : SearchRows(40.0F) {}

    Search<Real> search(const Vec3& goal, WorkBudget& budget) { return this->template search_for<Real>(goal, budget); }
    /// The active constraints push the point away from the goal, and none pulls: no other point is as near.
    void expect_nearest(const Search<Real>& found, const Vec3& goal) const
    {
        ASSERT_GT(found.basis().size, 0U);
        Eigen::MatrixXd normals(3, found.basis().size);
        for (Eigen::Index k = 0; k < normals.cols(); ++k) {
            normals.col(k) = rows[found.basis().rows[static_cast<std::size_t>(k)]].normal.template cast<double>();
        }
        const Eigen::Vector3d way = (found.x() - goal).template cast<double>();
        const Eigen::VectorXd shares = enumerated::shares_of(normals, way);
        EXPECT_GE(shares.minCoeff(), -1e-4 * shares.norm());
        EXPECT_LE((normals * shares - way).norm(), 1e-4 * way.norm());
    }
    [[nodiscard]] float rounding() const { return 4.0F * Tolerance<float>(scale).outside; }
};
using ContractPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(SearchContract, ContractPrecisions);
using SearchOfFloats = SearchContract<float>;
using SearchOfWides = SearchContract<DoubleFloat>;

// --- rounding makes it go round: the whole program once, in the given order ---

/// Half-spaces of a random search of which one that is held is the most violated one again, in single precision.
struct GoesRound {
    Vec3 goal;
    std::vector<Row> rows;
};
const GoesRound kThatHold[] = {{{1.35628F, -2.21928F, 0.698916F},
                                {{{0.60373652F, -0.19250539F, -0.77359164F}, 0.14914946F},
                                 {{0.57735026F, -0.57735026F, -0.57735026F}, 0.43102702F},
                                 {{-0.61460817F, 0.18430389F, 0.76699996F}, 0.43014404F}}},
                               {{-1, 1.25F, 0},
                                {{{0, 0, 1}, 0.29880017F},
                                 {{0, 0.70710677F, -0.70710677F}, -0.34401205F},
                                 {{0, 0, 1}, 0.29877201F},
                                 {{0, -0.70710677F, -0.70710677F}, -0.078551278F}}},
                               {{0.640370429F, -0.150210187F, -1.19221389F},
                                {{{-0.141307831F, -0.597418904F, 0.789381266F}, 0.383968532F},
                                 {{0.123834491F, 0.615488052F, -0.778356969F}, -0.819241524F},
                                 {{0.148712382F, 0.578744709F, -0.801834881F}, 0.164599299F}}},
                               {{0.340224266F, -2.65357733F, -0.716130853F},
                                {{{-0.707106769F, -0.707106769F, 0}, 0.609016001F},
                                 {{0, 1, 0}, -0.838112295F},
                                 {{0, 1, 0}, -0.838112295F},
                                 {{0.726650059F, 0.390005082F, -0.56557548F}, -0.264674336F},
                                 {{1, 0, 0}, -0.023163192F}}}};
/// The same, that leave no point but by rounding.
const GoesRound kThatDoNotHold[] = {{{0.25F, -1.5F, 1.25F},
                                     {{{0, 0.707106769F, -0.707106769F}, 0.702721477F},
                                      {{-0.995159686F, 0.08135584F, -0.055121474F}, -0.608278871F},
                                      {{0.995388329F, -0.0797148496F, 0.0533634163F}, 0.610115945F},
                                      {{0.995359659F, -0.0799613148F, 0.0535294712F}, 0.609890461F},
                                      {{-0.995392561F, 0.0797458887F, -0.0532380193F}, -0.610155582F},
                                      {{0.995370448F, -0.0799543485F, 0.0533375069F}, 0.609980464F}}},
                                    {{-1.5F, 0.25F, 1.5F},
                                     {{{-0.6F, -0.8F, 0}, 0.379062533F},
                                      {{0, -0.6F, 0.8F}, 0.166561067F},
                                      {{-0.708982646F, 0.642099082F, 0.29163745F}, 0.010610261F},
                                      {{0.8F, 0, -0.6F}, -0.21212855F}}},
                                    {{-0.522540748F, 1.13735616F, 0.43344143F},
                                     {{{0.719920218F, 0.149358213F, -0.677795589F}, -0.203675419F},
                                      {{0.176837757F, 0.974023402F, 0.141445354F}, -0.145029843F},
                                      {{-0.501157582F, -0.386733294F, 0.774130821F}, 0.443945378F},
                                      {{-0.687359691F, 0.618142486F, -0.381361365F}, -0.767553806F},
                                      {{0.852680624F, -0.305393994F, -0.423875302F}, 0.179643258F}}},
                                    {{0.25F, -1.5F, -1.25F},
                                     {{{0, 0, -1}, -0.381253242F},
                                      {{0, -1, 0}, 0.380822539F},
                                      {{1, 0, 0}, -0.129075751F},
                                      {{0, 0.6F, -0.8F}, -0.533466816F},
                                      {{0, 0, 1}, 0.381219596F}}}};

class GoingRound : public SearchOfFloats {
protected:
    void take(const GoesRound& given)
    {
        clear();
        for (const Row& row : given.rows) {
            add(row.normal, row.offset);
        }
    }
};

/// It ends, at the nearest point that all of them leave free: as in twice the precision.
TEST_F(GoingRound, TheNearestPointIsFoundAllTheSame)
{
    for (const GoesRound& given : kThatHold) {
        take(given);
        WorkBudget budget(kEnough);
        Search<float> s = search(given.goal, budget);
        ASSERT_EQ(s.nearest(rows.size()), Found::optimum);
        EXPECT_LE(outside(rows.size(), s.x()), rounding());
        shifted = rows;
        Search<DoubleFloat> exact(spheres, given.goal, {shifted, derived, yields, held}, scale, budget);
        if (exact.nearest(rows.size()) != Found::optimum) {
            continue;  // it holds by rounding alone
        }
        const float off = (exact.x() - given.goal).norm();
        EXPECT_NEAR((s.x() - given.goal).norm(), off, 1e-4F * std::max(1.0F, off));
    }
}

/// If the search reports an optimum, all constraints hold.
TEST_F(GoingRound, WhatBreaksARowIsNoOptimum)
{
    for (const GoesRound& given : kThatDoNotHold) {
        take(given);
        WorkBudget budget(kEnough);
        Search<float> s = search(given.goal, budget);
        const Found found = s.nearest(rows.size());
        EXPECT_NE(found, Found::exhausted);
        EXPECT_TRUE(found == Found::nothing || outside(rows.size(), s.x()) <= rounding());
    }
}

/// If the budget runs out anywhere, this is reported: neither a point nor infeasibility.
TEST_F(GoingRound, ABudgetThatRunsOutIsSaid)
{
    for (const auto& all : {std::span<const GoesRound>(kThatHold), std::span<const GoesRound>(kThatDoNotHold)}) {
        for (const GoesRound& given : all) {
            take(given);
            WorkBudget plenty(kEnough);
            const Found found = search(given.goal, plenty).nearest(rows.size());
            for (std::uint32_t units = 0; units <= plenty.spent(); ++units) {
                WorkBudget budget(units);
                ASSERT_EQ(search(given.goal, budget).nearest(rows.size()),
                          units < plenty.spent() ? Found::exhausted : found)
                    << units << " of " << plenty.spent();
            }
        }
    }
}

/// An answer that rounding may have left open stays so, for any later active constraints.
TEST_F(GoingRound, WhatWasOpenStaysOpen)
{
    int open = 0;
    for (const auto& all : {std::span<const GoesRound>(kThatHold), std::span<const GoesRound>(kThatDoNotHold)}) {
        for (const GoesRound& given : all) {
            take(given);
            for (std::size_t from = 0; from < rows.size(); ++from) {
                WorkBudget budget(kEnough);
                Search<float> s = search(given.goal, budget);
                bool before = false;
                const auto expect_kept = [&] {
                    EXPECT_TRUE(!before || s.is_blunt());
                    before = s.is_blunt();
                    open += before ? 1 : 0;
                };
                static_cast<void>(s.nearest(rows.size()));
                expect_kept();
                s.judge(rows.size());
                expect_kept();
                if (s.nearest(from) != Found::optimum) {
                    continue;
                }
                s.judge(from);
                expect_kept();
                float broken = 0.0F;
                if (s.relax(from, rows.size(), broken) == Found::optimum) {
                    expect_kept();
                }
            }
        }
    }
    EXPECT_GT(open, 20);
}

/// In double-float there is no such fallback: an unfinished search is reported, although budget is left.
TEST_F(SearchOfWides, GoingRoundIsNoContradiction)
{
    add({-0.152856186F, 0.142239839F, -0.9779585F}, 0.333230585F);
    add({0.918348134F, 0.271769613F, 0.287711293F}, 0.144205362F);
    add({-0.937762678F, 0.346394658F, 0.0247365944F}, -0.212174386F);
    add({0.749499679F, -0.629064023F, 0.206224918F}, 0.0571843833F);
    WorkBudget budget(kEnough);
    EXPECT_NE(search({0.368240684F, 2.80374002F, 0.0683479756F}, budget).nearest(4), Found::nothing)
        << "there is a point";
}

// --- many turns ---

/// Planes about a sphere of 1 m/s, all within `width` of the direction to the goal.
template <class Test>
Vec3 add_about(Test& test, Random& random, std::size_t count, float width)
{
    const Vec3 axis = unit(random);
    for (std::size_t i = 0; i < count; ++i) {
        test.push(-(axis + width * unit(random)).normalized(), -1.0F);
    }
    return axis;
}

template <class Real>
class ManyTurns : public SearchContract<Real> {
public:
    void push(const Vec3& normal, float offset) { this->add(normal, offset); }
};
TYPED_TEST_SUITE(ManyTurns, ContractPrecisions);

/// A goal so far off that each iteration progresses by less than the distance's rounding: more iterations than the
/// search permits.
TYPED_TEST(ManyTurns, ThoseThatHardlyGetOnEndAtTheNearestPoint)
{
    Random random(20270101);
    for (int i = 0; i < 40; ++i) {
        this->clear();
        const Vec3 goal = 3000.0F * add_about(*this, random, 100, 0.02F);
        WorkBudget budget(kEnough);
        Search<TypeParam> s = this->search(goal, budget);
        ASSERT_EQ(s.nearest(100), Found::optimum) << i;
        ASSERT_LE(this->outside(100, s.x()), 8.0F * this->rounding()) << i;
        if (!s.is_blunt()) {
            this->expect_nearest(s, goal);
        }
    }
}

/// Few active rows: for planes at large angles none is open, for any number of iterations.
TYPED_TEST(ManyTurns, RowsThatAreLetGoOpenNothing)
{
    Random random(20270102);
    for (int i = 0; i < 50; ++i) {
        this->clear();
        const Vec3 goal = 3.0F * add_about(*this, random, 60, 0.5F);
        WorkBudget budget(kEnough);
        Search<TypeParam> s = this->search(goal, budget);
        ASSERT_EQ(s.nearest(60), Found::optimum) << i;
        ASSERT_FALSE(s.is_blunt()) << i;
        ASSERT_LE(this->outside(60, s.x()), this->rounding());
    }
}

}  // namespace
}  // namespace jink::orca
