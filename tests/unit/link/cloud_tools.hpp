// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/link/cloud/frame.hpp"
#include "firmware/link/cloud/receiver.hpp"

// The driver's side of a cloud line for tests, and a recording sink.

namespace jink::link::cloud::test {

using Bytes = std::vector<std::byte>;

/// Records all calls in order.
struct Recorder final : CloudSink {
    struct Scan {
        CloudScan scan;
        std::vector<std::pair<Ray, Vec3>> rays;
        bool ended = false;
        std::uint32_t lost = 0;
    };
    void begin_scan(const CloudScan& scan) noexcept override
    {
        broken = broken || (!scans.empty() && !scans.back().ended);
        scans.push_back({scan, {}, false, 0});
    }
    void add(Ray ray, const Vec3& point) noexcept override
    {
        broken = broken || scans.empty() || scans.back().ended;
        if (!broken) {
            scans.back().rays.emplace_back(ray, point);
        }
    }
    void end_scan(std::uint32_t points_lost) noexcept override
    {
        broken = broken || scans.empty() || scans.back().ended;
        if (!broken) {
            scans.back().ended = true;
            scans.back().lost = points_lost;
        }
    }
    [[nodiscard]] std::size_t rays() const
    {
        std::size_t n = 0;
        for (const Scan& scan : scans) {
            n += scan.rays.size();
        }
        return n;
    }
    std::vector<Scan> scans;
    bool broken = false;  ///< calls came out of order
};

/// Counts only.
struct Counter final : CloudSink {
    void begin_scan(const CloudScan& /*scan*/) noexcept override { ++begun; }
    void add(Ray /*ray*/, const Vec3& /*point*/) noexcept override { ++points; }
    void end_scan(std::uint32_t points_lost) noexcept override
    {
        ++ended;
        lost += points_lost;
    }
    std::uint64_t begun = 0, ended = 0, points = 0, lost = 0;
};

inline Bytes frame_of(const Part& part, std::span<const RawPoint> points)
{
    Bytes bytes(kMaxFrame);
    bytes.resize(write_frame(part, points, bytes));
    return bytes;
}

/// A sender with its running numbers: whole scans as frames.
struct Driver {
    std::vector<Bytes> scan(std::span<const RawPoint> points, std::uint32_t stamp_ms,
                            std::size_t per_frame = kMaxPoints)
    {
        Part part = first;
        part.scan = number++;
        part.stamp_ms = stamp_ms;
        part.scan_points = static_cast<std::uint32_t>(points.size());
        part.parts = static_cast<std::uint16_t>(points.empty() ? 1 : (points.size() + per_frame - 1) / per_frame);
        std::vector<Bytes> frames;
        for (std::uint16_t i = 0; i < part.parts; ++i) {
            part.part = i;
            part.sequence = sequence++;
            const std::size_t at = i * per_frame;
            frames.push_back(frame_of(part, points.subspan(at, std::min(per_frame, points.size() - at))));
        }
        return frames;
    }
    Part first = [] {
        Part part;
        part.sensor = 3;
        part.max_range = 10000;
        return part;
    }();
    std::uint16_t number = 0;
    std::uint16_t sequence = 0;
};

inline std::vector<RawPoint> random_points(Random& random, std::size_t n)
{
    std::vector<RawPoint> points(n);
    for (RawPoint& point : points) {
        point.azimuth = static_cast<std::int16_t>(static_cast<int>(random.below(2 * kHalfTurn + 1)) - kHalfTurn);
        point.elevation =
            static_cast<std::int16_t>(static_cast<int>(random.below(2 * kQuarterTurn + 1)) - kQuarterTurn);
        point.range = static_cast<std::uint16_t>(random.below(65536));
    }
    return points;
}

inline Bytes joined(const std::vector<Bytes>& frames)
{
    Bytes all;
    for (const Bytes& frame : frames) {
        all.insert(all.end(), frame.begin(), frame.end());
    }
    return all;
}

}  // namespace jink::link::cloud::test
