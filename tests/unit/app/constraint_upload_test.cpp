// SPDX-License-Identifier: BSD-3-Clause
// Sets of closed areas received over the link in parts: when they take effect, and effects of lost, wrong or repeated
// parts.
#include <gtest/gtest.h>

#include "firmware/app/constraint_upload.hpp"

#include <memory>

#include "firmware/link/mavlink/constraint_message.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app {
namespace {

using link::ConstraintPart;
using link::ConstraintResult;
constexpr TimePoint kAt{50'000'000};

ConstraintPart part_of(std::uint8_t set, std::uint8_t index, std::uint8_t count, float east = 100.0F)
{
    ConstraintPart part;
    part.constraint.cylinder = {{{east, 0.0F}, 10.0F}, {0.0F, 0.0F}, 0.0F, 100.0F, 0.0F};
    part.constraint.stamp = kAt;
    part.set = set;
    part.index = index;
    part.count = count;
    part.from_system = 255;
    part.from_component = 190;
    return part;
}

TEST(ConstraintUpload, ASetCountsOnceAllItsPartsHaveCome)
{
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(part_of(1, 2, 3, 30.0F), kAt), ConstraintResult::kept);
    EXPECT_EQ(upload.take(part_of(1, 0, 3, 10.0F), kAt), ConstraintResult::kept);
    EXPECT_FALSE(upload.is_new());
    EXPECT_EQ(upload.take(part_of(1, 0, 3, 11.0F), kAt), ConstraintResult::kept) << "again";
    EXPECT_EQ(upload.take(part_of(1, 1, 3, 20.0F), kAt), ConstraintResult::in_force);
    ASSERT_TRUE(upload.is_new());
    ASSERT_EQ(upload.set().size(), 3U);
    EXPECT_EQ(upload.set()[0].cylinder.circle.centre.x(), 11.0F) << "the later value";
    EXPECT_EQ(upload.set()[2].cylinder.circle.centre.x(), 30.0F);
    upload.mark_in_force();
    EXPECT_FALSE(upload.is_new());
    EXPECT_EQ(upload.diagnostics().sets, 1U);
    EXPECT_EQ(upload.diagnostics().abandoned, 0U);
}

/// A sender that has started anew counts from the same number again: its areas are others.
TEST(ConstraintUpload, ThePartOfACompleteSetReplacesTheFormer)
{
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(part_of(1, 0, 1, 10.0F), kAt), ConstraintResult::in_force);
    upload.mark_in_force();
    EXPECT_EQ(upload.take(part_of(1, 0, 1, 500.0F), kAt), ConstraintResult::in_force);
    ASSERT_TRUE(upload.is_new());
    EXPECT_EQ(upload.set()[0].cylinder.circle.centre.x(), 500.0F);
}

/// With two areas that change places, a mixture of both sets would leave one of them open.
TEST(ConstraintUpload, ASetWithTheNumberOfTheOneInForceReplacesItAsAWhole)
{
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(part_of(1, 0, 2, 10.0F), kAt), ConstraintResult::kept);
    EXPECT_EQ(upload.take(part_of(1, 1, 2, 500.0F), kAt), ConstraintResult::in_force);
    upload.mark_in_force();
    EXPECT_EQ(upload.take(part_of(1, 0, 2, 500.0F), kAt), ConstraintResult::kept);
    EXPECT_FALSE(upload.is_new());
    EXPECT_EQ(upload.take(part_of(1, 1, 2, 10.0F), kAt), ConstraintResult::in_force);
    ASSERT_TRUE(upload.is_new());
    EXPECT_EQ(upload.set()[0].cylinder.circle.centre.x(), 500.0F);
    EXPECT_EQ(upload.set()[1].cylinder.circle.centre.x(), 10.0F);
    EXPECT_EQ(upload.diagnostics().sets, 2U);
    EXPECT_EQ(upload.diagnostics().abandoned, 0U);
}

TEST(ConstraintUpload, EachValueThatDiffersFromTheSetInForceBeginsAnother)
{
    const auto result_after = [](const auto& change) {
        ConstraintUpload upload;
        static_cast<void>(upload.take(part_of(1, 0, 2), kAt));
        EXPECT_EQ(upload.take(part_of(1, 1, 2), kAt), ConstraintResult::in_force);
        ConstraintPart part = part_of(1, 1, 2);
        change(part.constraint);
        return upload.take(part, kAt);
    };
    EXPECT_EQ(result_after([](link::Constraint&) {}), ConstraintResult::in_force) << "its answer was lost";
    EXPECT_EQ(result_after([](link::Constraint& c) { c.stamp = {kAt.us - 3000}; }), ConstraintResult::in_force)
        << "the line's delay varies";
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.circle.centre.y() = 1.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.circle.radius = 11.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.velocity.x() = 1.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.bottom = 1.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.top = 99.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.cylinder.margin = 1.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) { c.ends = kAt + 60.0F; }), ConstraintResult::kept);
    EXPECT_EQ(result_after([](link::Constraint& c) {
                  c.about = link::GlobalPosition{1, 2, 0};
              }),
              ConstraintResult::kept);
}

/// The end counts from the instant of the position, which the line's delay moves.
TEST(ConstraintUpload, ARepetitionWithAnEndIsRecognized)
{
    ConstraintUpload upload;
    ConstraintPart part = part_of(1, 0, 2);
    part.constraint.ends = part.constraint.stamp + 60.0F;
    static_cast<void>(upload.take(part, kAt));
    EXPECT_EQ(upload.take(part_of(1, 1, 2), kAt), ConstraintResult::in_force);
    part.constraint.stamp.us -= 3000;
    part.constraint.ends.us -= 3000;
    EXPECT_EQ(upload.take(part, kAt), ConstraintResult::in_force);
}

TEST(ConstraintUpload, AnotherSetSenderOrCountAbandonsAnIncompleteOne)
{
    ConstraintUpload upload;
    const auto keep = [&](const ConstraintPart& part) { EXPECT_EQ(upload.take(part, kAt), ConstraintResult::kept); };
    keep(part_of(1, 0, 2));
    keep(part_of(2, 0, 2));
    keep(part_of(2, 0, 3));
    ConstraintPart other = part_of(2, 1, 3);
    other.from_system = 254;
    keep(other);
    other.from_component = 1;
    keep(other);
    EXPECT_EQ(upload.diagnostics().abandoned, 4U);
    EXPECT_FALSE(upload.is_new());
}

/// Merged, as a board does with more than two, they would all be placed in one of the frames.
TEST(ConstraintUpload, APartInAnotherFrameThanTheOthersIsRefused)
{
    const auto on_globe = [](ConstraintPart part) {
        part.constraint.about = link::GlobalPosition{473977420, 85465940, 0};
        return part;
    };
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(part_of(1, 0, 3), kAt), ConstraintResult::kept);
    EXPECT_EQ(upload.take(on_globe(part_of(1, 1, 3)), kAt), ConstraintResult::out_of_range);
    EXPECT_EQ(upload.diagnostics().refused, 1U);
    EXPECT_FALSE(upload.is_new());
    EXPECT_EQ(upload.take(part_of(1, 1, 3), kAt), ConstraintResult::kept) << "mended";
    EXPECT_EQ(upload.take(part_of(1, 2, 3), kAt), ConstraintResult::in_force);
    upload.mark_in_force();
    EXPECT_EQ(upload.take(on_globe(part_of(2, 0, 2)), kAt), ConstraintResult::kept) << "another set";
    EXPECT_EQ(upload.take(part_of(2, 1, 2), kAt), ConstraintResult::out_of_range);
    EXPECT_EQ(upload.take(part_of(2, 0, 2), kAt), ConstraintResult::kept) << "the only part so far, again";
    EXPECT_EQ(upload.take(part_of(2, 1, 2), kAt), ConstraintResult::in_force);
}

TEST(ConstraintUpload, AnEmptySetOpensEverything)
{
    ConstraintUpload upload;
    ConstraintPart none;
    none.set = 4;
    EXPECT_EQ(upload.take(none, kAt), ConstraintResult::in_force);
    EXPECT_TRUE(upload.is_new());
    EXPECT_TRUE(upload.set().empty());
}

TEST(ConstraintUpload, WhatIsWrongIsRefusedAndChangesNothing)
{
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(part_of(1, 0, 2), kAt), ConstraintResult::kept);
    EXPECT_EQ(upload.take(part_of(2, 0, link::kMaxReportedConstraints + 1), kAt), ConstraintResult::too_many);
    EXPECT_EQ(upload.take(part_of(2, 0, 255), kAt), ConstraintResult::too_many);
    std::uint32_t refused = 2;
    const auto refuse = [&](const auto& change) {
        ConstraintPart part = part_of(1, 1, 2);
        change(part.constraint);
        EXPECT_EQ(upload.take(part, kAt), ConstraintResult::out_of_range);
        EXPECT_EQ(upload.diagnostics().refused, ++refused);
    };
    refuse([](link::Constraint& c) { c.cylinder.circle.radius = 0.0F; });
    refuse([](link::Constraint& c) { c.cylinder.circle.radius = kNan; });
    refuse([](link::Constraint& c) { c.cylinder.top = -1.0F; });
    refuse([](link::Constraint& c) { c.cylinder.bottom = -kInfinity; });
    refuse([](link::Constraint& c) { c.cylinder.velocity.x() = 1e6F; });
    refuse([](link::Constraint& c) { c.cylinder.margin = -1.0F; });
    refuse([](link::Constraint& c) { c.stamp = kAt + 1.0F; });
    refuse([](link::Constraint& c) { c.about = link::GlobalPosition{900000001, 0, 0}; });
    EXPECT_EQ(upload.diagnostics().abandoned, 0U) << "a refused part of another set abandons nothing";
    EXPECT_EQ(upload.take(part_of(1, 1, 2), kAt), ConstraintResult::in_force);
}

/// Whole chain: bytes in, answers out, and the closed areas used by the planner.
class CoprocessorConstraintUpload : public testing::Test {
protected:
    void SetUp() override { f->fly(100); }

    ConstraintResult report(const ConstraintPart& part)
    {
        link::mavlink::Tunnel m = link::mavlink::constraint_message(part, f->now);
        m.target_system = test::wire::kSystem;
        m.target_component = test::wire::kUs;
        f->feed(m);
        f->fly(1);
        const auto answers = f->said_of<link::mavlink::Tunnel>();
        EXPECT_EQ(answers.size(), 1U);
        link::mavlink::ConstraintAnswer answer;
        EXPECT_TRUE(!answers.empty() && link::mavlink::read_constraint_answer(answers[0], answer));
        return answer.result;
    }
    ConstraintPart area(std::uint8_t set, std::uint8_t index, std::uint8_t count)
    {
        ConstraintPart part = part_of(set, index, count, 300.0F);
        part.constraint.stamp = f->now;
        return part;
    }

    std::unique_ptr<test::Flight> f = std::make_unique<test::Flight>();
};

TEST_F(CoprocessorConstraintUpload, TheFormerSetCountsUntilTheNextIsWhole)
{
    EXPECT_EQ(report(area(1, 0, 1)), ConstraintResult::in_force);
    f->fly(1);
    EXPECT_EQ(f->last.cylinders, 1U);
    EXPECT_EQ(report(area(2, 0, 2)), ConstraintResult::kept);
    f->fly(1);
    EXPECT_EQ(f->last.cylinders, 1U);
    EXPECT_EQ(report(area(2, 1, 2)), ConstraintResult::in_force);
    f->fly(1);
    EXPECT_EQ(f->last.cylinders, 2U);
    ConstraintPart none;
    none.set = 3;
    EXPECT_EQ(report(none), ConstraintResult::in_force);
    f->fly(1);
    EXPECT_EQ(f->last.cylinders, 0U);
    EXPECT_EQ(f->coprocessor.constraint_upload_diagnostics().sets, 3U);
}

TEST_F(CoprocessorConstraintUpload, ARefusalLeavesWhatIsInForce)
{
    EXPECT_EQ(report(area(1, 0, 1)), ConstraintResult::in_force);
    ConstraintPart bad = area(2, 0, 1);
    bad.constraint.cylinder.circle.radius = -1.0F;
    EXPECT_EQ(report(bad), ConstraintResult::out_of_range);
    f->fly(1);
    EXPECT_EQ(f->last.cylinders, 1U);
    EXPECT_EQ(f->coprocessor.constraint_upload_diagnostics().refused, 1U);
}

}  // namespace
}  // namespace jink::app
