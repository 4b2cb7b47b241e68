// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/linux/live_page/snapshot.hpp"

namespace jink::livepage {

using flightlog::AreaTopic;
using flightlog::CandidateTopic;
using flightlog::DecisionTopic;
using flightlog::NominalTopic;
using flightlog::ObstacleTopic;
using flightlog::OwnTopic;
using flightlog::StepTopic;
using flightlog::TopicId;
using flightlog::TrackTopic;
using Json = nlohmann::json;

inline constexpr std::uint64_t kStart = 5'000'000'000;  // [us]

/// Messages of a flight log, one by one, and the events that a page is sent.
class SnapshotTest : public testing::Test {
protected:
    Snapshot snapshot{{1.5F, 8.0F, 1.0F}};

    void take(ulog::Type type, std::span<const std::byte> content)
    {
        std::array<std::byte, 70'000> buffer{};
        snapshot.take(ulog::Composer(buffer).begin(type).put_bytes(content).end());
    }
    template <class T>
    void take(TopicId id, const T& topic)
    {
        std::array<std::byte, 1024> buffer{};
        snapshot.take(ulog::Composer(buffer)
                          .begin(ulog::Type::data)
                          .put(static_cast<std::uint16_t>(id))
                          .put_bytes(flightlog::content_of(topic))
                          .end());
    }
    void take_step(double seconds, std::uint8_t own_source = 1)
    {
        StepTopic step;
        step.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        step.own_source = own_source;
        take(TopicId::step, step);
    }
    void take_track(std::uint32_t id, double seconds, const flightlog::Xyz& at, const flightlog::Xyz& velocity,
                    std::uint8_t instance = 0)
    {
        TrackTopic track;
        track.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        track.id = id;
        track.position = at;
        track.velocity = velocity;
        track.radius = 2.0F;
        track.instance = instance;
        take(TopicId::track, track);
    }
    void take_decision(std::uint32_t number, double seconds, std::size_t candidates, std::size_t chosen = 1000)
    {
        DecisionTopic decision;
        decision.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        decision.decision = number;
        decision.start = {10.0F, 20.0F, 30.0F};
        decision.own_at_closest = {50.0F, 20.0F, 30.0F};
        take(TopicId::decision, decision);
        for (std::size_t i = 0; i < candidates; ++i) {
            take_candidate(number, static_cast<float>(i), i == chosen ? 1 : 6);
        }
    }
    void take_candidate(std::uint32_t number, float offset, std::uint8_t status, std::uint8_t family = 0)
    {
        CandidateTopic candidate;
        candidate.decision = number;
        candidate.offset = offset;
        candidate.status = status;
        candidate.family = family;
        candidate.time = 2.0F;
        candidate.cost = 0.5F;
        take(TopicId::candidate, candidate);
    }
    void take_nominal(double seconds, std::uint8_t path, std::uint8_t segment, const flightlog::Xyz& start,
                      float length, float radius = 0.0F, float speed = 5.0F)
    {
        NominalTopic nominal;
        nominal.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        nominal.start = start;
        nominal.along = {1.0F, 0.0F, 0.0F};
        nominal.towards = {0.0F, 1.0F, 0.0F};
        nominal.radius = radius;
        nominal.length = length;
        nominal.speed = speed;
        nominal.path = path;
        nominal.segment = segment;
        nominal.on_route = path == 0;
        take(TopicId::nominal, nominal);
    }
    /// A step that knows so many obstacles and closed areas.
    void take_knowing(double seconds, std::size_t obstacles, std::size_t areas)
    {
        StepTopic step;
        step.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        step.obstacles = static_cast<std::uint16_t>(obstacles);
        step.areas = static_cast<std::uint16_t>(areas);
        take(TopicId::step, step);
    }
    /// A box, the number-th obstacle of a round.
    static ObstacleTopic box(double seconds, std::size_t number, std::size_t obstacles, std::size_t areas)
    {
        ObstacleTopic box;
        box.timestamp = box.known = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        box.id = 100 + static_cast<std::uint32_t>(number);
        box.centre = {static_cast<float>(number), 2.0F, 3.0F};
        box.half = {0.5F, 1.0F, 2.0F};
        box.turn = {1.0F, 0.0F, 0.0F, 0.0F};
        box.uncertainty = 0.25F;
        box.number = static_cast<std::uint16_t>(number);
        box.obstacles = static_cast<std::uint16_t>(obstacles);
        box.areas = static_cast<std::uint16_t>(areas);
        box.kind = 1;
        return box;
    }
    static AreaTopic area(double seconds, std::size_t number, std::size_t obstacles, std::size_t areas)
    {
        AreaTopic area;
        area.timestamp = area.known = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        area.centre = {10.0F, static_cast<float>(number)};
        area.velocity = {0.0F, 3.0F};
        area.radius = 12.0F;
        area.bottom = -5.0F;
        area.top = 120.0F;
        area.margin = 6.0F;
        area.number = static_cast<std::uint16_t>(number);
        area.obstacles = static_cast<std::uint16_t>(obstacles);
        area.areas = static_cast<std::uint16_t>(areas);
        return area;
    }
    void take_round(double seconds, std::size_t obstacles, std::size_t areas)
    {
        for (std::size_t i = 0; i < obstacles; ++i) {
            take(TopicId::obstacle, box(seconds, i, obstacles, areas));
        }
        for (std::size_t i = 0; i < areas; ++i) {
            take(TopicId::area, area(seconds, i, obstacles, areas));
        }
    }
    void take_own(double seconds, const flightlog::Xyz& at)
    {
        OwnTopic own;
        own.timestamp = own.measured = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        own.position = at;
        take(TopicId::own, own);
    }
    void take_text(std::string_view text)
    {
        std::array<std::byte, 512> buffer{};
        snapshot.take(
            ulog::Composer(buffer).begin(ulog::Type::text).put(ulog::Level::warning).put(kStart).put_text(text).end());
    }
    [[nodiscard]] Json event(bool all = false) const { return Json::parse(snapshot.json(all, {1, 2, 3, 4})); }
};

}  // namespace jink::livepage
