// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "hal/memory/memory_serial_link.hpp"
#include "toolchain/sim/timing.hpp"
#include "toolchain/sim/tunnel_line.hpp"

namespace jink::sim {

/// A serial cable in memory. This object is the autopilot's end; Port is the co-processor's end.
class Cable final : public LineEnd {
public:
    Cable(hal::Clock& clock, std::uint64_t seed, const Timing& timing)
        : link_(clock, seed), there_(timing, kThere), back_(timing, kBack), port_(*this)
    {
    }
    std::size_t read(std::span<std::byte> into) override { return link_.a().read(into); }
    bool write(std::span<const std::byte> bytes) override
    {
        set_latency(link_.a_to_b(), there_);
        return link_.a().write(bytes) == bytes.size();
    }
    hal::SerialPort& port() { return port_; }

private:
    static constexpr std::uint64_t kThere = 1;
    static constexpr std::uint64_t kBack = 2;

    /// The co-processor's end.
    class Port final : public hal::SerialPort {
    public:
        explicit Port(Cable& cable) : cable_(cable) {}
        [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
        {
            return cable_.link_.b().read(into);
        }
        [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
        {
            set_latency(cable_.link_.b_to_a(), cable_.back_);
            return cable_.link_.b().write(from);
        }
        [[nodiscard]] hal::PortHealth health() const noexcept override { return cable_.link_.b().health(); }

    private:
        Cable& cable_;
    };

    static void set_latency(hal::MemoryLine& line, Delays& delays)
    {
        hal::LineFaults faults;
        faults.latency_us = delays.next();
        line.set_faults(faults);
    }

    hal::MemorySerialLink link_;
    Delays there_;
    Delays back_;
    Port port_;
};

}  // namespace jink::sim
