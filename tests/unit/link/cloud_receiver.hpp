// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <vector>

#include "firmware/link/cloud/receiver.hpp"
#include "tests/unit/link/cloud_tools.hpp"

namespace jink::link::cloud::test {

class CloudReceiver : public ::testing::Test {
protected:
    void hear(std::span<const std::byte> bytes) { receiver->receive(bytes, now, sink); }
    void hear(const std::vector<Bytes>& frames) { hear(joined(frames)); }
    void wait(float seconds)
    {
        now = now + seconds;
        hear(std::span<const std::byte>{});
    }
    [[nodiscard]] std::uint32_t sender_ms() const { return static_cast<std::uint32_t>(now.us / 1000) - 7000; }
    /// `n` points ahead, a metre apart.
    static std::vector<RawPoint> row(std::size_t n)
    {
        std::vector<RawPoint> points(n);
        for (std::size_t i = 0; i < n; ++i) {
            points[i].range = static_cast<std::uint16_t>(100 * (i + 1));
        }
        return points;
    }
    std::vector<Bytes> frames(std::size_t points, std::size_t per_frame = kMaxPoints)
    {
        return driver.scan(row(points), sender_ms(), per_frame);
    }
    [[nodiscard]] const ReceiverDiagnostics& count() const { return receiver->diagnostics(); }
    /// Every byte and every point is accounted for.
    void expect_sums(std::size_t bytes_heard) const
    {
        EXPECT_FALSE(sink.broken);
        EXPECT_EQ(count().frame_bytes + count().noise_bytes + receiver->pending(), bytes_heard);
        EXPECT_EQ(count().points + (receiver->is_scan_open() ? sink.scans.back().rays.size() : 0), sink.rays());
    }

    std::unique_ptr<Receiver> receiver = std::make_unique<Receiver>();
    Recorder sink;
    Driver driver;
    TimePoint now{10'000'000};
};

}  // namespace jink::link::cloud::test
