// SPDX-License-Identifier: BSD-3-Clause
// When parameters are saved: never in the air or while the autopilot may be airborne, and values after a restart.
#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/app/param_keeper.hpp"
#include "tests/memory_flash.hpp"
#include "tests/unit/app/flight.hpp"
#include "tests/unit/app/step_bench.hpp"

namespace jink::app {
namespace {

using test::Flight;
using Store = hal::MemoryFlash<4096>;

/// A board from its start on, over flash that outlives it.
class Board {
public:
    explicit Board(hal::FlashRegion& flash, const Parameters& own = {}) : flight(own), flash_(flash)
    {
        flight.armed = false;
        flight.hovers = true;
        keeper.start(flight.coprocessor);
    }

    void fly(int ticks)
    {
        for (int i = 0; i < ticks; ++i) {
            keeper.work(flight.coprocessor, flight.now);
            flight.fly(1);
            for (const auto& text : flight.said_of<link::mavlink::Statustext>()) {
                texts += std::string(text.text.data(), strnlen(text.text.data(), text.text.size())) + "\n";
            }
        }
    }
    void set(std::string_view name, float value)
    {
        link::mavlink::ParamSet m;
        std::copy(name.begin(), name.end(), m.param_id.begin());
        m.param_value = value;
        m.param_type = 9;
        m.target_system = link::mavlink::test::kSystem;
        m.target_component = link::mavlink::test::kUs;
        flight.feed(m);
    }
    [[nodiscard]] float get(Param p) const { return flight.coprocessor.parameters().get(p); }
    [[nodiscard]] std::size_t said(std::string_view what) const
    {
        std::size_t n = 0;
        for (std::size_t at = texts.find(what); at != std::string::npos; at = texts.find(what, at + 1)) {
            ++n;
        }
        return n;
    }

    Flight flight;
    std::string texts;

private:
    hal::FlashRegion& flash_;
    ParamFlash store_{flash_};

public:
    ParamKeeper keeper{store_};
};

float age_after_restart(hal::FlashRegion& flash) { return std::make_unique<Board>(flash)->get(Param::track_age); }

TEST(ParamKeeper, WhatIsSetWhileDisarmedIsKeptInTheNextTick)
{
    Store flash;
    const auto board = std::make_unique<Board>(flash);
    board->fly(100);
    EXPECT_EQ(flash.steps(), 0U);
    board->set("TRK_AGE", 9.0F);
    board->fly(1);
    EXPECT_EQ(board->get(Param::track_age), 9.0F);
    board->fly(1);
    EXPECT_EQ(age_after_restart(flash), 9.0F);
    const auto again = std::make_unique<Board>(flash);
    EXPECT_EQ(again->flight.coprocessor.initial_parameters(), Parameters().values()) << "what erase brings back";
    EXPECT_EQ(again->flight.coprocessor.parameters().configuration().tracks.max_age, 9.0F);
    again->fly(100);
    EXPECT_EQ(again->texts.find("param"), std::string::npos) << again->texts;
}

TEST(ParamKeeper, AChangeInTheAirWaitsUntilTheVehicleIsDisarmed)
{
    Store flash;
    const auto board = std::make_unique<Board>(flash);
    board->flight.armed = true;
    board->fly(100);
    board->set("TRK_AGE", 9.0F);
    board->fly(500);
    EXPECT_EQ(flash.steps(), 0U);
    EXPECT_EQ(age_after_restart(flash), 3.0F) << "a restart in the air loses it";
    board->flight.armed = false;
    board->fly(52);  // the next HEARTBEAT
    EXPECT_EQ(age_after_restart(flash), 9.0F);
}

TEST(ParamKeeper, NothingIsWrittenOnAnOldHeartbeatOrWithoutOne)
{
    for (const bool heard : {false, true}) {
        Store flash;
        const auto board = std::make_unique<Board>(flash);
        board->flight.heartbeats = heard;
        board->fly(100);
        board->flight.heartbeats = false;
        board->fly(80);                              // 1.6 s, far below HB_AGE
        ParamValues values = Parameters().values();  // as over the bus: MAVLink's are not taken before a HEARTBEAT
        values[static_cast<std::size_t>(Param::track_age)] = 9.0F;
        ASSERT_EQ(board->flight.coprocessor.restore_parameters(values), 0U);
        board->fly(100);
        EXPECT_EQ(flash.steps(), 0U) << heard;
        board->flight.heartbeats = true;
        board->fly(60);
        EXPECT_EQ(age_after_restart(flash), 9.0F);
    }
}

TEST(ParamKeeper, ARestartAnnouncesWhatIsStored)
{
    Store flash;
    {
        const auto board = std::make_unique<Board>(flash);
        board->fly(60);
        board->set("JNK_MODE", 1.0F);
        board->fly(2);
    }
    const auto board = std::make_unique<Board>(flash);
    board->fly(60);
    link::mavlink::ParamRequestRead ask;
    ask.param_index = 0;
    ask.target_system = link::mavlink::test::kSystem;
    ask.target_component = link::mavlink::test::kUs;
    board->flight.feed(ask);
    board->fly(1);
    const auto answers = board->flight.said_of<link::mavlink::ParamValue>();
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0].param_value, 1.0F);
}

TEST(ParamKeeper, TheImagesOwnValuesAreNotStoredAndFollowTheImage)
{
    Store flash;
    {
        const auto board = std::make_unique<Board>(flash);
        board->fly(60);
        board->set("TRK_AGE", 9.0F);
        board->fly(2);
    }
    Parameters newer;
    ASSERT_EQ(newer.set(Param::lookahead, 11.0F), ParamStatus::ok);
    ASSERT_EQ(newer.set(Param::track_age, 5.0F), ParamStatus::ok);
    const auto board = std::make_unique<Board>(flash, newer);
    EXPECT_EQ(board->get(Param::lookahead), 11.0F);
    EXPECT_EQ(board->get(Param::track_age), 9.0F);
    board->fly(60);
    board->set("TRK_AGE", 5.0F);
    board->fly(2);
    EXPECT_EQ(age_after_restart(flash), 3.0F);
}

TEST(ParamKeeper, AFailureIsSaidOnceAndTriedAgainAfterTenSeconds)
{
    Store flash;
    const auto board = std::make_unique<Board>(flash);
    board->fly(60);
    flash.cut_at(0, 0);
    board->set("TRK_AGE", 9.0F);
    board->fly(1200);
    EXPECT_EQ(board->said("jink: parameters are not stored"), 1U) << board->texts;
    EXPECT_EQ(age_after_restart(flash), 3.0F);
    flash.restore();
    board->fly(501);
    EXPECT_EQ(age_after_restart(flash), 9.0F);
    flash.cut_at(0, 0);
    board->set("TRK_AGE", 10.0F);
    board->fly(60);
    EXPECT_EQ(board->said("jink: parameters are not stored"), 2U) << "another row of failures";
}

TEST(ParamKeeper, AFailureIsNotTriedAgainBeforeItsTime)
{
    Store flash;
    const auto board = std::make_unique<Board>(flash);
    board->fly(60);
    flash.cut_at(0, 0);
    board->set("TRK_AGE", 9.0F);
    board->fly(5);
    flash.restore();
    board->fly(480);
    EXPECT_EQ(age_after_restart(flash), 3.0F) << "9.6 s";
    board->fly(30);
    EXPECT_EQ(age_after_restart(flash), 9.0F);
}

/// Answer to "save" on the bus: whether a restart would restore the present values.
TEST(ParamKeeper, TheBusIsReportedWhetherARestartBringsThePresentValues)
{
    Store flash;
    ParamFlash store(flash);
    ParamKeeper keeper(store);
    const auto b = std::make_unique<test::StepBench>(std::initializer_list<std::pair<Param, float>>{},
                                                     test::StepBench::Bus::there);
    keeper.start(b->coprocessor);
    EXPECT_EQ(b->coprocessor.parameters().generation(), 0U) << "nothing is stored, nothing changes";
    ASSERT_NE(b->bus.params, nullptr);
    EXPECT_TRUE(b->bus.params->save());
    b->bus.params->write(static_cast<std::uint16_t>(Param::track_age), 9.0F);
    EXPECT_FALSE(b->bus.params->save());
    b->hear_autopilot();
    b->hear_own();
    b->step();
    keeper.work(b->coprocessor, b->now);
    EXPECT_FALSE(b->bus.params->save()) << "armed";
    b->hear_autopilot().armed = false;
    b->step();
    keeper.work(b->coprocessor, b->now);
    EXPECT_TRUE(b->bus.params->save());
    EXPECT_EQ(age_after_restart(flash), 9.0F);
}

TEST(ParamKeeper, DamageIsSaidToThePilot)
{
    Store flash;
    {
        const auto board = std::make_unique<Board>(flash);
        board->fly(60);
        board->set("TRK_AGE", 9.0F);
        board->fly(2);
    }
    flash.flip(0, 0x1C, 1);
    const auto board = std::make_unique<Board>(flash);
    board->fly(60);
    EXPECT_EQ(board->get(Param::track_age), 3.0F);
    EXPECT_EQ(board->said("jink: stored parameters damaged, left out"), 1U) << board->texts;
}

TEST(ParamKeeper, StoredValuesThatNoLongerFitTheImageAreLeftOutAndSaid)
{
    Store flash;
    {
        const auto board = std::make_unique<Board>(flash);
        board->fly(60);
        board->set("TRK_AGE", 9.0F);
        board->set("JNK_CEILING", 0.0F);
        board->fly(2);
        ASSERT_EQ(board->get(Param::ceiling), 0.0F);
    }
    Parameters newer;
    ASSERT_EQ(newer.set(Param::bounds, 3.0F), ParamStatus::ok);  // a ceiling below the floor fits no more
    const auto board = std::make_unique<Board>(flash, newer);
    board->fly(60);
    EXPECT_EQ(board->get(Param::track_age), 9.0F);
    EXPECT_EQ(board->get(Param::ceiling), 120.0F);
    EXPECT_EQ(board->said("jink: some stored parameters left out"), 1U) << board->texts;
}

}  // namespace
}  // namespace jink::app
