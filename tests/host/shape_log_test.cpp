// SPDX-License-Identifier: BSD-3-Clause
// Obstacles and closed areas of a log, as the page of a flight draws them: how long each is believed.
#include <gtest/gtest.h>

#include <cstdint>

#include "toolchain/host/shape_log.hpp"

namespace {

using namespace jink::host;
using jink::flightlog::AreaTopic;
using jink::flightlog::ObstacleTopic;

constexpr std::uint64_t kStart = 7'000'000;

/// Rounds of spheres along x, and steps.
class ShapeLogTest : public testing::Test {
protected:
    ShapeLog log;

    /// @param places  x of each obstacle, whose id is its number
    void take_round(double seconds, const std::vector<float>& places, bool has_area = false)
    {
        log.note_step(seconds, true);
        for (std::size_t i = 0; i < places.size(); ++i) {
            ObstacleTopic o;
            fill(o, seconds, i, places.size(), has_area);
            o.id = static_cast<std::uint32_t>(i);
            o.centre = {places[i], 0.0F, 0.0F};
            o.turn = {1.0F, 0.0F, 0.0F, 0.0F};
            o.radius = 1.0F;
            log.note_obstacle(LogFields(*jink::ulog::parse_format(std::string(ObstacleTopic::kFormat)),
                                        jink::flightlog::content_of(o)),
                              seconds);
        }
        if (has_area) {
            AreaTopic a;
            fill(a, seconds, 0, places.size(), has_area);
            a.radius = 5.0F;
            a.bottom = -2.0F;
            a.top = 10.0F;
            log.note_area(
                LogFields(*jink::ulog::parse_format(std::string(AreaTopic::kFormat)), jink::flightlog::content_of(a)),
                seconds);
        }
    }
    /// (x, from, until) of each shape.
    [[nodiscard]] std::vector<std::array<double, 3>> spans() const
    {
        std::vector<std::array<double, 3>> all;
        for (const PageShape& shape : log.shapes()) {
            all.push_back({shape.centre[0], shape.from, shape.until});
        }
        return all;
    }

private:
    template <class T>
    static void fill(T& topic, double seconds, std::size_t number, std::size_t obstacles, bool has_area)
    {
        topic.timestamp = topic.known = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        topic.number = static_cast<std::uint16_t>(number);
        topic.obstacles = static_cast<std::uint16_t>(obstacles);
        topic.areas = has_area ? 1 : 0;
    }
};

using Spans = std::vector<std::array<double, 3>>;

TEST_F(ShapeLogTest, WhatStaysIsOneShapeAndWhatChangesEndsAtTheNextRound)
{
    take_round(1.0, {3.0F, 4.0F}, true);
    take_round(2.0, {3.0F, 5.0F}, true);
    take_round(3.0, {3.0F}, true);
    EXPECT_EQ(spans(), (Spans{{3.0, 1.0, 5.0}, {4.0, 1.0, 2.0}, {0.0, 1.0, 5.0}, {5.0, 2.0, 3.0}}));
    const PageShape& area = log.shapes()[2];
    EXPECT_EQ(area.kind, PageShape::kArea);
    EXPECT_EQ(area.centre[2], 4.0);
    EXPECT_EQ(area.half[2], 6.0);
    EXPECT_EQ(area.radius, 5.0);
}

TEST_F(ShapeLogTest, WithoutARoundForTwoSecondsNothingIsBelieved)
{
    take_round(1.0, {3.0F});
    log.note_step(2.5, true);
    take_round(3.5, {3.0F});
    EXPECT_EQ(spans(), (Spans{{3.0, 1.0, 3.0}, {3.0, 3.5, 5.5}}));
}

TEST_F(ShapeLogTest, AStepThatKnowsNothingEndsAll)
{
    take_round(1.0, {3.0F, 4.0F});
    log.note_step(1.5, false);
    log.note_step(1.52, true);
    EXPECT_EQ(spans(), (Spans{{3.0, 1.0, 1.5}, {4.0, 1.0, 1.5}}));
    take_round(1.6, {3.0F});
    EXPECT_EQ(spans(), (Spans{{3.0, 1.0, 1.5}, {4.0, 1.0, 1.5}, {3.0, 1.6, 3.6}}));
}

}  // namespace
