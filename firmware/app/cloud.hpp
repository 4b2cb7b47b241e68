// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/capacity.hpp"
#include "core/geometry/shape.hpp"
#include "core/world/obstacle_table.hpp"
#include "firmware/app/clouds.hpp"

namespace jink::app {

/// Obstacles that one scan gives to the world, the nearest. Half the table: a level scan of 72 sectors keeps two thirds
/// of its own beside them, and a ring that is closed all around and a cloud that is full in every direction at once
/// leave the nearest 96 of 120, for the table lets the farthest go, and counts it. CloudDiagnostics::no_room
/// counts the obstacles of a cloud that do not fit.
inline constexpr std::size_t kMaxCloudObstacles = 48;
static_assert(kMaxCloudObstacles <= 1024);

/// Where rays and obstacles went, since start. Each hit is counted once among body, below_floor, beyond, behind and
/// kept.
struct CloudDiagnostics {
    std::uint64_t hits = 0;
    std::uint64_t nothing = 0;
    std::uint64_t invalid = 0;
    std::uint64_t body = 0;         ///< hits within the own box
    std::uint64_t below_floor = 0;  ///< hits under the floor, which bounds the flight already
    std::uint64_t beyond = 0;       ///< hits farther than kReach
    std::uint64_t behind = 0;       ///< hits behind the patch that was the nearest in their direction when they came
    std::uint64_t kept = 0;
    std::uint64_t lost = 0;  ///< rays that the sender sent
    std::uint32_t scans = 0;
    std::uint32_t scans_unplaced = 0;  ///< where the vehicle was is not known: they give nothing
    std::uint32_t obstacles = 0;       ///< given to the table, which counts what it refuses
    std::uint32_t no_room = 0;         ///< directions with a hit beyond the kMaxCloudObstacles nearest
};

/// Nearest surface in each direction of a polar image about the vehicle, and its share of the world's obstacles.
///
/// A bin is a direction: kColumns azimuths by kRows elevations between -45 and 45 degrees, the outermost rows reaching
/// to the poles. It keeps the nearest hit and the extent, in angle and range, of the hits from there to patch_depth()
/// behind. At the end of a scan each of the kMaxCloudObstacles nearest becomes a sphere that holds all of that extent,
/// and so every such hit of the bin. What lies farther behind in the same direction is not reported until the nearer
/// one is gone. A bin that was seen to be empty gives its former obstacle up; one of which rays are missing, or that
/// the own body hides, leaves it to expire.
///
/// Hits are placed by the own position at the scan's stamp, flown on or back from the newest one, and by the own yaw as
/// known when the scan began. The sensor counts as the vehicle's centre.
///
/// Memory: 8 bytes for each of kBins, and 290. add() is O(1); end_scan() O(kBins * (kMaxCloudObstacles +
/// kMaxObstacles)). Nothing is allocated.
class CloudObstacles final : public link::CloudSink {
public:
    static constexpr std::size_t kColumns = 36;
    static constexpr std::size_t kRows = 9;
    static constexpr std::size_t kBins = kColumns * kRows;
    /// What is farther is not kept [m].
    static constexpr float kReach = 600.0F;
    /// Least depth of a patch [m], and its share of the range: a plane seen at up to 60 degrees from its normal lies
    /// within 0.3 times the range across a bin of 10 degrees.
    static constexpr float kMinDepth = 1.0F;
    static constexpr float kDepthShare = 0.3F;
    /// Hits this far below the floor are dropped, no higher ones: the vehicle may have moved since the scan [m].
    static constexpr float kFloorSlack = 0.5F;

    /// @param first_id  of the obstacles: 256 sensors * 512 ids from there on are this image's own
    explicit CloudObstacles(std::uint32_t first_id) noexcept : first_id_(first_id) {}

    /// Where obstacles go at the end of each scan; outlives the last scan. Without one they go nowhere.
    void give_to(world::ObstacleTable& table) noexcept { table_ = &table; }
    /// Holds for scans that begin after this.
    void look_from(const CloudView& view) noexcept { next_view_ = view; }

    void begin_scan(const link::CloudScan& scan) noexcept override;
    void add(link::Ray ray, const Vec3& point) noexcept override;
    void end_scan(std::uint32_t points_lost) noexcept override;

    [[nodiscard]] const CloudDiagnostics& diagnostics() const noexcept { return diagnostics_; }

    /// How far behind the nearest hit a patch reaches [m].
    [[nodiscard]] static float patch_depth(float nearest) noexcept;
    /// Bin of a direction of any length, not zero. O(1).
    [[nodiscard]] static std::size_t bin_of(const Vec3& direction) noexcept;

private:
    /// Ranges in centimetres, rounded outwards; angles in 255ths of the bin, rounded outwards.
    struct Bin {
        std::uint16_t nearest = kUnseen;
        std::uint16_t farthest = 0;
        std::uint8_t left = 0, right = 0, low = 0, high = 0;
    };
    // In place of a nearest range: no hit, and what is known of the bin.
    static constexpr std::uint16_t kUnseen = 65535;
    static constexpr std::uint16_t kEmpty = 65534;    ///< seen to be empty
    static constexpr std::uint16_t kSpoiled = 65533;  ///< hidden by the body, or of rays that are not valid
    static_assert(kReach * 100.0F < static_cast<float>(kSpoiled));

    struct Direction;
    [[nodiscard]] static bool has_hit(const Bin& bin) noexcept { return bin.nearest < kSpoiled; }
    [[nodiscard]] static Direction direction_of(const Vec3& point) noexcept;
    [[nodiscard]] static geometry::Shape local_sphere(std::size_t index, const Bin& bin) noexcept;
    void add_hit(const Vec3& point) noexcept;
    void keep(Bin& bin, const Direction& direction, float range) noexcept;
    void give(std::size_t index) noexcept;
    [[nodiscard]] std::uint32_t id_of(std::size_t index) const noexcept;

    std::uint32_t first_id_;
    world::ObstacleTable* table_ = nullptr;
    CloudView next_view_;
    CloudView view_;  ///< position: at the scan's stamp
    link::CloudScan scan_;
    float cos_yaw_ = 1.0F;
    float sin_yaw_ = 0.0F;
    CloudDiagnostics diagnostics_;
    std::array<Bin, kBins> bins_{};
};

}  // namespace jink::app
