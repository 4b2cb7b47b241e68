// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <memory>
#include <vector>

#include "firmware/app/cloud_input.hpp"
#include "tests/unit/app/flight.hpp"
#include "tests/unit/link/cloud_tools.hpp"

namespace jink::app::test {

namespace cloud = link::cloud;

/// A line of unlimited capacity: bytes pass from one end to the other, whole or not at all.
class CloudLine final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), waiting());
        if (n > 0) {
            std::memcpy(into.data(), bytes_.data() + at_, n);
        }
        at_ += n;
        return n;
    }
    std::size_t write(std::span<const std::byte> /*from*/) noexcept override { return 0; }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = hal::PortState::open;
        return health;
    }
    void feed(std::span<const std::byte> bytes)
    {
        if (waiting() == 0) {
            bytes_.clear();
            at_ = 0;
        }
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    [[nodiscard]] std::size_t waiting() const { return bytes_.size() - at_; }

private:
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

/// A flight with a LiDAR aboard, its attitude level and known.
struct CloudFlight {
    explicit CloudFlight(bool has_port = true) : input(has_port ? &line : nullptr)
    {
        flight.coprocessor.use_clouds(input);
    }

    StepReport tick()
    {
        flight.prepare();
        if (attitude) {
            flight.feed(wire::attitude(flight.boot_ms(), 0.5F * kPi));  // nose north, as it flies
        }
        const StepReport report = flight.step();
        flight.react();
        return report;
    }
    void fly(int n)
    {
        for (int i = 0; i < n; ++i) {
            tick();
        }
    }
    [[nodiscard]] std::uint32_t driver_ms() const { return static_cast<std::uint32_t>(flight.now.us / 1000) + 500'000; }

    CloudLine line;
    CloudInput input;
    Flight flight;
    cloud::test::Driver driver;
    bool attitude = true;
};

/// A point ahead (0) or to the left (90) at `elevation` [degrees, m].
inline cloud::RawPoint raw(float azimuth, float elevation, float range)
{
    constexpr float kUnits = kPi / 180.0F / cloud::kAngleUnit;
    return {static_cast<std::int16_t>(std::lround(azimuth * kUnits)),
            static_cast<std::int16_t>(std::lround(elevation * kUnits)),
            static_cast<std::uint16_t>(std::lround(range * 100.0F))};
}

}  // namespace jink::app::test
