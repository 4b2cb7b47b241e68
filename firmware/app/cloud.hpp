// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/world/obstacle_table.hpp"
#include "firmware/app/cloud_cover.hpp"
#include "firmware/app/clouds.hpp"

namespace jink::app {

/// Where rays and obstacles went, since start. Each hit is counted once among body, below_floor, beyond and kept.
struct CloudDiagnostics {
    std::uint64_t hits = 0;
    std::uint64_t nothing = 0;
    std::uint64_t invalid = 0;
    std::uint64_t body = 0;         ///< hits within the own box
    std::uint64_t below_floor = 0;  ///< hits under the floor and lower than the vehicle
    std::uint64_t beyond = 0;       ///< hits farther than kReach
    std::uint64_t kept = 0;
    std::uint64_t lost = 0;  ///< rays that the sender sent
    std::uint32_t scans = 0;
    std::uint32_t scans_unplaced = 0;  ///< where the vehicle was is not known: they give nothing
    std::uint32_t obstacles = 0;       ///< given to the table, which counts what it refuses
    std::uint32_t left_out = 0;        ///< parts beyond sure_range() that did not fit
    std::uint32_t coarse = 0;          ///< obstacles that hold more than they should, for want of others
    std::uint32_t remembered = 0;      ///< surfaces that a scan could not see again, kept until they expire
};

/// What the rays of a scan hit, as a share of the world's obstacles.
///
/// Every hit of a scan that is kept and lies within sure_range() is within an obstacle: the surfaces of all directions
/// (CloudBin) are held by at most kMaxCloudObstacles boxes (CloudCover), coarser where there is more to tell. They take
/// the place of those of the sensor's former scan. What was seen in a direction that the scan does not see again (rays
/// lost, not valid, hidden by the own body, outside the field of view) stays where it was in the world until it expires
/// or its place is seen; what is hidden by the body and close to it does not expire.
///
/// Hits are placed by the own position at the scan's stamp, flown on or back from the newest one, and by the own yaw as
/// known when the scan began. The sensor counts as the vehicle's centre.
///
/// Memory: about 180 KiB, for computers that have LiDARs. add() is O(1); end_scan() as CloudCover, and
/// O(kMaxCloudObstacles * kMaxObstacles). Nothing is allocated.
class CloudObstacles final : public link::CloudSink {
public:
    /// What is farther is not kept [m].
    static constexpr float kReach = 600.0F;
    /// Hits this far below the floor are dropped, no higher ones: the vehicle may have moved since the scan [m].
    /// Hits no lower than the vehicle's centre are kept: it may fly below the floor. The ground under a vehicle that
    /// lands, stands or takes off lies lower than its centre, though within its box.
    static constexpr float kFloorSlack = 0.5F;
    /// What is hidden by the own body and no farther from its box than this is not forgotten [m].
    static constexpr float kBodyReach = 0.5F;

    /// @param first_id  of the obstacles: 256 sensors * 512 ids from there on are this image's own
    explicit CloudObstacles(std::uint32_t first_id) noexcept : first_id_(first_id) {}

    /// Where obstacles go at the end of each scan; outlives the last scan. Without one they go nowhere.
    void give_to(world::ObstacleTable& table) noexcept { table_ = &table; }
    /// Holds for scans that begin after this.
    void look_from(const CloudView& view) noexcept { next_view_ = view; }

    void begin_scan(const link::CloudScan& scan) noexcept override;
    void add(link::Ray ray, const Vec3& point) noexcept override;
    void end_scan(std::uint32_t points_lost) noexcept override;

    /// What is nearer than this is always reported [m]: kSureStops times what the vehicle needs to stop, and
    /// kSureLeast.
    [[nodiscard]] static float sure_range(const CloudView& view) noexcept;
    static constexpr float kSureStops = 2.0F;
    static constexpr float kSureLeast = 15.0F;

    [[nodiscard]] const CloudDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    /// A surface of a former scan, as an upright box in the world.
    struct Remembered {
        geometry::Shape box;
        TimePoint expires;
        std::uint8_t sensor = 0;
    };
    /// Two surfaces in every direction, of one sensor or of several that see less; what does not fit is not remembered.
    static constexpr std::size_t kMaxRemembered = CloudImage::kBins * CloudBin::kLayers;

    void add_hit(const Vec3& point) noexcept;
    void remember(bool all_came) noexcept;
    void give() noexcept;
    [[nodiscard]] geometry::Shape to_world(const geometry::Shape& local) const noexcept;
    [[nodiscard]] geometry::Shape to_local(const geometry::Shape& world) const noexcept;

    std::uint32_t first_id_;
    world::ObstacleTable* table_ = nullptr;
    CloudView next_view_;
    CloudView view_;  ///< position: at the scan's stamp
    link::CloudScan scan_;
    Mat3 turn_ = Mat3::Identity();  ///< from the sensor's frame to the world's
    CloudDiagnostics diagnostics_;
    CloudImage image_;
    StaticVector<Remembered, kMaxRemembered> memory_;
};

}  // namespace jink::app
