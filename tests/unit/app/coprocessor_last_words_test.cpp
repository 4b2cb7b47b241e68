// SPDX-License-Identifier: BSD-3-Clause
// Text prepared for a fault handler, report of the previous fault after a start, and staying passive.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

struct LastWordsFlight : testing::Test {
    std::unique_ptr<Flight> f = std::make_unique<Flight>();
    hal::LastWords words{};
    void SetUp() override
    {
        words.clear();
        f->coprocessor.keep_last_words(words);
    }
    [[nodiscard]] std::vector<Received> said() const
    {
        Parser reader;
        return wire::parse(reader, words.valid());
    }
    [[nodiscard]] std::size_t holds() const
    {
        const auto commands = all_of<CommandLong>(said());
        return static_cast<std::size_t>(std::count_if(commands.begin(), commands.end(), [](const CommandLong& m) {
            return m.command == 176 && m.param2 == 17.0F;
        }));
    }
    [[nodiscard]] std::size_t texts(std::string_view begin) const
    {
        const auto all = f->said_of<Statustext>();
        return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const Statustext& t) {
            return std::string_view(t.text.data(), begin.size()) == begin;
        }));
    }
};

TEST_F(LastWordsFlight, AskForAHoldExactlyWhileInControl)
{
    unsigned in_control = 0;
    unsigned wrong = 0;
    const auto check = [&](const StepReport& r) {
        // Returning: the former mode was asked for in this step, and a second request needs another HEARTBEAT.
        const bool ours = r.control == Control::ours;
        in_control += ours ? 1U : 0U;
        wrong += (holds() == 2) == ours && (holds() == 0) == !ours ? 0U : 1U;
        const auto heartbeats = all_of<Heartbeat>(said());
        wrong += heartbeats.size() == 1 && heartbeats[0].system_status == (ours ? 6 : 5) ? 0U : 1U;
    };
    for (int i = 0; i < 200; ++i) {
        check(f->tick());
    }
    EXPECT_EQ(in_control, 0U);
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    for (int i = 0; i < 1500; ++i) {
        check(f->tick());
    }
    EXPECT_GT(in_control, 50U);
    EXPECT_EQ(f->last.control, Control::autopilot) << "given back in the end";
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(all_of<Statustext>(said()).size(), 1U);
}

TEST_F(LastWordsFlight, NoticesWaitForTheAutopilotAndAreReportedOnce)
{
    Text text;
    text << "jink: restart 1";
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(f->coprocessor.tell_when_heard(link::Severity::critical, text));
    }
    EXPECT_FALSE(f->coprocessor.tell_when_heard(link::Severity::critical, text));
    f->heartbeats = false;
    f->fly(100);
    std::size_t reported = 0;
    f->heartbeats = true;
    for (int i = 0; i < 200; ++i) {
        f->fly(1);
        reported += texts("jink: restart 1");
    }
    EXPECT_EQ(reported, 3U);
}

TEST_F(LastWordsFlight, PassiveItSaysCriticalAndAsksForNothing)
{
    f->coprocessor.stay_passive();
    f->fly(100);
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    for (int i = 0; i < 1500; ++i) {
        f->fly(1);
        ASSERT_EQ(f->last.state, link::SystemState::critical);
        ASSERT_EQ(f->last.work, 0U) << "nothing is planned";
        ASSERT_TRUE(f->mode_requests().empty());
        ASSERT_EQ(all_of<Statustext>(said()).size(), 0U) << "in a row of faults the line is not flooded";
        ASSERT_EQ(all_of<Heartbeat>(said()).size(), 1U);
    }
    EXPECT_EQ(f->setpoints, 0);
    EXPECT_EQ(f->mode, wire::kCopterAuto);
    EXPECT_GT(f->watchdog.fed, 1500) << "healthy all the same";
}

TEST(Text, WritesHexadecimal)
{
    Text text;
    text << Hex{0x0800ABCD} << " " << Hex{0} << " " << Hex{0xFFFFFFFF};
    EXPECT_EQ(text.view(), "0800ABCD 00000000 FFFFFFFF");
}

}  // namespace
}  // namespace jink::app::test
