// SPDX-License-Identifier: BSD-3-Clause
// Closed areas over TUNNEL: the payload byte by byte, accepted and refused parts, and the answers.
#include <gtest/gtest.h>

#include <bit>

#include "firmware/link/mavlink/constraint_message.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

class MavlinkConstraints : public HeardEndpointTest {
protected:
    static constexpr std::uint8_t kStation = 255;
    static constexpr std::uint8_t kStationComponent = 190;

    /// A payload written by hand, so that the code's own table of fields is no witness in its own cause.
    static Tunnel area()
    {
        Tunnel m;
        m.payload_type = 35344;
        m.target_system = kSystem;
        m.target_component = kUs;
        m.payload_length = 48;
        m.payload = {
            1,    1,    7, 1, 3,    0,    0,    0,    // version, kind, set, index, count, frame
            0xE8, 0x03, 0, 0, 0x3C, 0,    0,    0,    // 1000 ms old, open after 60 s
            0x10, 0x27, 0, 0, 0xE0, 0xB1, 0xFF, 0xFF  // 10000 mm north, -20000 mm east
        };
        put(m, 24, 5.0F);
        put(m, 28, 120.0F);
        put(m, 32, 12.0F);
        put(m, 36, 6.0F);
        put(m, 40, 3.0F);
        put(m, 44, -1.0F);
        return m;
    }
    static void put(Tunnel& m, std::size_t at, float value)
    {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (std::size_t i = 0; i < 4; ++i) {
            m.payload[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
        }
    }
    /// The one answer that has gone out.
    ConstraintAnswer answer()
    {
        const Tunnel m = sent_one<Tunnel>();
        ConstraintAnswer read;
        EXPECT_TRUE(read_constraint_answer(m, read));
        EXPECT_EQ(m.target_system, kStation);
        EXPECT_EQ(m.target_component, kStationComponent);
        return read;
    }
    void expect_malformed(const Tunnel& m)
    {
        const std::uint32_t before = count().out_of_range;
        from(kStation, kStationComponent, m);
        EXPECT_TRUE(inbox->constraints.empty());
        EXPECT_EQ(count().out_of_range, before + 1);
        EXPECT_EQ(answer().result, ConstraintResult::malformed);
    }
};

TEST_F(MavlinkConstraints, AnAreaOfTheLocalFrameIsReadByteByByte)
{
    from(kStation, kStationComponent, area());
    ASSERT_EQ(inbox->constraints.size(), 1U);
    const ConstraintPart& part = inbox->constraints[0];
    EXPECT_EQ(part.set, 7);
    EXPECT_EQ(part.index, 1);
    EXPECT_EQ(part.count, 3);
    EXPECT_EQ(part.from_system, kStation);
    EXPECT_EQ(part.from_component, kStationComponent);
    const Constraint& c = part.constraint;
    EXPECT_FALSE(c.about);
    EXPECT_EQ(c.stamp.us, now.us - 1'000'000);
    EXPECT_EQ(c.ends.us, now.us + 59'000'000);
    EXPECT_EQ(c.cylinder.circle.centre, world::Vec2(-20.0F, 10.0F)) << "east, north";
    EXPECT_EQ(c.cylinder.velocity, world::Vec2(-1.0F, 3.0F));
    EXPECT_EQ(c.cylinder.bottom, 5.0F);
    EXPECT_EQ(c.cylinder.top, 120.0F);
    EXPECT_EQ(c.cylinder.circle.radius, 12.0F);
    EXPECT_EQ(c.cylinder.margin, 6.0F);
    EXPECT_TRUE(sent().empty()) << "the application answers";
}

TEST_F(MavlinkConstraints, AnAreaOnTheGlobeKeepsItsPlace)
{
    Tunnel m = area();
    m.payload[5] = 1;
    m.payload[12] = 0;
    from(kStation, kStationComponent, m);
    ASSERT_EQ(inbox->constraints.size(), 1U);
    const Constraint& c = inbox->constraints[0].constraint;
    ASSERT_TRUE(c.about);
    EXPECT_EQ(*c.about, (GlobalPosition{10000, -20000, 0}));
    EXPECT_EQ(c.cylinder.circle.centre, world::Vec2(0.0F, 0.0F));
    EXPECT_EQ(c.ends, Constraint{}.ends) << "closed until another set comes";
}

TEST_F(MavlinkConstraints, WhatIsWrittenIsReadAgain)
{
    ConstraintPart part;
    part.constraint.cylinder = {{{-20.5F, 10.25F}, 12.0F}, {1.0F, 2.0F}, 3.0F, 4.0F, 5.0F};
    part.constraint.stamp = {now.us - 500'000};
    part.constraint.ends = {now.us + 9'500'000};
    part.set = 250;
    part.index = 2;
    part.count = 8;
    ConstraintPart read;
    ASSERT_TRUE(read_constraint(constraint_message(part, now), now, read));
    EXPECT_EQ(read.constraint.cylinder.circle.centre, part.constraint.cylinder.circle.centre);
    EXPECT_EQ(read.constraint.cylinder.velocity, part.constraint.cylinder.velocity);
    EXPECT_EQ(read.constraint.stamp, part.constraint.stamp);
    EXPECT_EQ(read.constraint.ends, part.constraint.ends);
    EXPECT_EQ(read.set, part.set);
    EXPECT_EQ(read.index, part.index);
    EXPECT_EQ(read.count, part.count);
    part.constraint.about = GlobalPosition{473977420, -85455940, 0};
    ASSERT_TRUE(read_constraint(constraint_message(part, now), now, read));
    EXPECT_EQ(read.constraint.about, part.constraint.about);
}

TEST_F(MavlinkConstraints, MalformedPayloadsAreRefusedAndAnswered)
{
    for (const auto& [at, value] : {std::pair<std::size_t, std::uint8_t>{0, 2}, {1, 0}, {3, 3}, {4, 1}, {5, 2}}) {
        SCOPED_TRACE(at);
        Tunnel m = area();
        m.payload[at] = value;
        expect_malformed(m);
    }
    for (const std::uint8_t length : {0, 1, 5, 47, 49, 128}) {
        SCOPED_TRACE(static_cast<int>(length));
        Tunnel m = area();
        m.payload_length = length;
        expect_malformed(m);
    }
    Tunnel m = area();
    m.payload[3] = 1;
    m.payload[4] = 0;
    expect_malformed(m);
}

TEST_F(MavlinkConstraints, AnAnswerNamesTheSetAndTheAreaItIsAbout)
{
    Tunnel m = area();
    m.payload[0] = 9;
    from(kStation, kStationComponent, m);
    const ConstraintAnswer got = answer();
    EXPECT_EQ(got.set, 7);
    EXPECT_EQ(got.index, 1);
}

/// Two co-processors that answer each other's answers would never stop.
TEST_F(MavlinkConstraints, AnswersAreNotAnswered)
{
    Tunnel m = constraint_answer({1, 2, ConstraintResult::kept});
    m.target_system = kSystem;
    m.target_component = kUs;
    from(kStation, kStationComponent, m);
    m.payload_length = 3;
    from(kStation, kStationComponent, m);
    EXPECT_TRUE(sent().empty());
    EXPECT_TRUE(inbox->constraints.empty());
    EXPECT_EQ(count().out_of_range, 0U);
}

TEST_F(MavlinkConstraints, OthersTunnelsArePassedOver)
{
    for (int i = 0; i < 3; ++i) {
        Tunnel m = area();
        m.target_system = i == 0 ? kSystem + 1 : kSystem;
        m.target_component = i == 1 ? 0 : kUs;
        m.payload_type = i == 2 ? 200 : 35344;
        from(kStation, kStationComponent, m);
    }
    EXPECT_TRUE(inbox->constraints.empty());
    EXPECT_TRUE(sent().empty());
    EXPECT_EQ(count().frames_ignored, 3U);
}

TEST_F(MavlinkConstraints, WhatFindsTheInboxFullIsCountedAndNotAnswered)
{
    for (std::size_t i = 0; i <= inbox->constraints.capacity(); ++i) {
        from(kStation, kStationComponent, area());
    }
    EXPECT_TRUE(inbox->constraints.full());
    EXPECT_EQ(count().inbox_full, 1U);
    EXPECT_TRUE(sent().empty());
}

TEST_F(MavlinkConstraints, DamagedAnswersAreNone)
{
    ConstraintAnswer read;
    const Tunnel good = constraint_answer({3, 4, ConstraintResult::too_many});
    ASSERT_TRUE(read_constraint_answer(good, read));
    EXPECT_EQ(read.result, ConstraintResult::too_many);
    for (const auto& [at, value] : {std::pair<std::size_t, std::uint8_t>{0, 2}, {1, 1}, {4, 5}}) {
        Tunnel m = good;
        m.payload[at] = value;
        EXPECT_FALSE(read_constraint_answer(m, read)) << at;
    }
    Tunnel m = good;
    m.payload_length = 4;
    EXPECT_FALSE(read_constraint_answer(m, read));
    m = good;
    m.payload_type = 0;
    EXPECT_FALSE(read_constraint_answer(m, read));
}

}  // namespace
}  // namespace jink::link::mavlink
