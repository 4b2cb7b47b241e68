// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/capacity.hpp"

namespace jink::path {

/// A point of a path that was sampled densely, as it is kept.
struct DensePoint {
    Vec3 position = Vec3::Zero();  ///< [m]
    std::uint32_t arrival_ms = 0;  ///< since the start of the path
    float along = 0.0F;            ///< arc length from the start of the chunk [m]
};

/// Why a path or a point of it is not taken.
enum class DenseStatus : std::uint8_t {
    ok,
    no_path,         ///< no load has been begun
    busy,            ///< both chunks hold what is still to be flown
    not_finite,      ///< a coordinate is none, or lies beyond DensePath::kFarthest
    time_not_later,  ///< arrivals must increase
    too_long,        ///< more than kMaxDensePoints points after decimation (PATH_TOO_LONG)
    too_few,         ///< not two points at different places
    gap,             ///< what is to continue a path does not begin where that ends, or that is complete
};

/// Keeps, of points that come one by one, those that the path needs (G-ORCA 13.3): what is left out lies within
/// kChordError of the segment that stands for it, and the speed of any two neighbours in it differs by no more than
/// kSpeedChange from that of its first two, beside the rounding of coordinates.
///
/// Greedy: a segment is made as long as can be. All directions from its start that pass within kChordError of each
/// point so far form a cone about each; of their intersection a cone is kept, which for a curve in a plane is all of
/// it. So a point is O(1) and none is remembered. An arc of radius r gets chords of up to 2 sqrt(2 r kChordError).
class Decimator {
public:
    static constexpr float kChordError = 0.01F;  ///< [m]
    static constexpr float kSpeedChange = 0.02F;

    struct Sample {
        Vec3 position = Vec3::Zero();
        std::uint32_t arrival_ms = 0;
    };
    void begin(const Sample& first) noexcept;
    /// True when the sample before this one has to be kept: `last()` until this call, given out in `kept`.
    [[nodiscard]] bool add(const Sample& sample, Sample& kept) noexcept;
    [[nodiscard]] const Sample& last() const noexcept { return last_; }

private:
    void start_segment(const Sample& from, const Sample& to) noexcept;
    [[nodiscard]] bool fits(const Sample& sample) const noexcept;
    void narrow(const Vec3& offset, float distance) noexcept;

    Sample anchor_;
    Sample last_;
    bool has_segment_ = false;
    float speed_ = 0.0F;     ///< of the segment's first two samples [m/s]
    float distance_ = 0.0F;  ///< of the last sample from the anchor [m]
    bool has_cone_ = false;
    Vec3 axis_ = Vec3::UnitX();
    float half_angle_ = 0.0F;  ///< [rad]
};

/// Two chunks of a dense path: one is flown while the other is loaded, point by point. What is loaded becomes the path
/// in whole or not at all; a chunk that fails leaves what is flown untouched.
///
/// A chunk either continues the path (streaming: it begins where the path ends, and is flown when its turn comes) or
/// replaces it. To replace a path that has a continuation takes the continuation's chunk: that is given up as soon as
/// the load begins, and the path then ends, incomplete, where the chunk ends that is flown. Memory: 20 bytes for each
/// of 2 kMaxDensePoints, 41 KiB by default. No allocation.
class DensePath {
public:
    static constexpr float kFarthest = 100'000.0F;  ///< coordinate [m]
    static constexpr float kJoin = 0.1F;            ///< a continuation begins this near to the end [m]

    /// Begins to load a chunk. Busy when it is to continue a path that has a continuation already. O(1).
    [[nodiscard]] DenseStatus begin(bool continues) noexcept;
    /// The next point. An error ends the load; nothing of it is kept. O(1).
    [[nodiscard]] DenseStatus add(const Vec3& position, std::uint32_t arrival_ms) noexcept;
    /// Takes the chunk over. O(1).
    /// @param last  the path ends with it; no more will come
    [[nodiscard]] DenseStatus commit(bool last) noexcept;
    /// Gives a load up.
    void abandon() noexcept { loading_ = false; }
    /// Forgets everything.
    void clear() noexcept;

    /// Points ahead that are known: of the chunk that is flown, and of its continuation without the point they share.
    [[nodiscard]] std::size_t size() const noexcept;
    [[nodiscard]] bool empty() const noexcept { return flown_points().empty(); }
    /// Point `i` < size(). O(1).
    [[nodiscard]] const DensePoint& point(std::size_t i) const noexcept;
    /// Arc length of point `i` from the start of the chunk that is flown [m].
    [[nodiscard]] float along(std::size_t i) const noexcept;
    /// Whether its end is the path's, not that of what is known so far.
    [[nodiscard]] bool is_complete() const noexcept { return chunks_[has_next_ ? other() : flown_].last; }
    /// Goes over to the continuation, if progress at segment `i` is past the chunk that is flown.
    /// @return `i` in the new numbering. O(1).
    [[nodiscard]] std::size_t advance(std::size_t i) noexcept;
    [[nodiscard]] bool has_continuation() const noexcept { return has_next_; }
    [[nodiscard]] bool is_loading() const noexcept { return loading_; }
    /// Counts the paths that replaced another one, so that whoever flies knows to begin anew.
    [[nodiscard]] std::uint32_t generation() const noexcept { return generation_; }

private:
    struct Chunk {
        StaticVector<DensePoint, kMaxDensePoints> points;
        bool last = true;
    };
    [[nodiscard]] std::size_t other() const noexcept { return 1 - flown_; }
    [[nodiscard]] const StaticVector<DensePoint, kMaxDensePoints>& flown_points() const noexcept
    {
        return chunks_[flown_].points;
    }
    [[nodiscard]] DenseStatus keep(const Decimator::Sample& sample) noexcept;
    [[nodiscard]] DenseStatus fail(DenseStatus why) noexcept;

    std::array<Chunk, 2> chunks_;
    std::size_t flown_ = 0;
    bool has_next_ = false;
    bool loading_ = false;
    bool continues_ = false;
    std::size_t taken_ = 0;  ///< samples of the load
    Decimator decimator_;
    std::uint32_t generation_ = 0;
};

}  // namespace jink::path
