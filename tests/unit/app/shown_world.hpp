// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/clouds.hpp"

namespace jink::app::test {

/// Receives the obstacle table and the co-processor's own state.
struct ShownWorld final : Clouds {
    void give_to(world::ObstacleTable& given) noexcept override { table = &given; }
    link::CloudSink& link_points() noexcept override { return sink; }
    void forward_to(link::CloudSink& /*sink*/) noexcept override {}
    void serve(TimePoint /*now*/, const CloudView& shown) noexcept override { view = shown; }

    struct Nowhere final : link::CloudSink {
        void begin_scan(const link::CloudScan& /*scan*/) noexcept override {}
        void add(link::Ray /*ray*/, const Vec3& /*point*/) noexcept override {}
        void end_scan(std::uint32_t /*points_lost*/) noexcept override {}
    } sink;
    world::ObstacleTable* table = nullptr;
    CloudView view;
};

}  // namespace jink::app::test
