// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/app/cloud.hpp"
#include "firmware/link/cloud/receiver.hpp"
#include "hal/serial_port.hpp"

namespace jink::app {

/// Scans of the cloud port that may begin in a step, and a few more within kPiece bytes: the end of a scan takes half a
/// millisecond on a slow computer. 200 a second are more than LiDARs send.
inline constexpr std::uint32_t kMaxCloudScansPerStep = 4;
/// Bytes read from the cloud port per step. 10^5 points ten times a second are 126 005 bytes in 20 ms; the rest lets a
/// late step catch up within four. What is left by then waits for the next step, and the step counts as a full one.
inline constexpr std::size_t kMaxCloudBytesPerStep = 160U * 1024U;

/// Point clouds on their way into the world: compact frames on a port of their own, and single points of the
/// autopilot's link. Each has an image of its own, because their scans overlap in time.
///
/// Owned by whoever has such a port: a Coprocessor that is given none pays a pointer. About 12 KiB, no allocation.
/// Neither copied nor moved.
class CloudInput final : public Clouds {
public:
    /// @param port  outlives this; nullptr: single points of the link alone
    explicit CloudInput(hal::SerialPort* port = nullptr) noexcept : port_(port) {}
    CloudInput(const CloudInput&) = delete;
    CloudInput& operator=(const CloudInput&) = delete;

    void give_to(world::ObstacleTable& table) noexcept override;
    /// The rays of the port, or of the link where there is no port.
    void forward_to(link::CloudSink& sink) noexcept override
    {
        (port_ != nullptr ? port_tee_ : link_tee_).also = &sink;
    }
    [[nodiscard]] link::CloudSink& link_points() noexcept override { return link_tee_; }

    /// Reads the port up to kMaxCloudBytesPerStep or kMaxCloudScansPerStep. O(bytes + scans that end * kBins).
    void serve(TimePoint now, const CloudView& view) noexcept override;

    [[nodiscard]] bool has_port() const noexcept { return port_ != nullptr; }
    [[nodiscard]] const link::cloud::ReceiverDiagnostics& receiver_diagnostics() const noexcept
    {
        return receiver_.diagnostics();
    }
    [[nodiscard]] const CloudDiagnostics& port_diagnostics() const noexcept { return port_image_.diagnostics(); }
    [[nodiscard]] const CloudDiagnostics& link_diagnostics() const noexcept { return link_image_.diagnostics(); }
    [[nodiscard]] std::uint64_t bytes_in() const noexcept { return bytes_in_; }
    /// Steps that took all they may: bytes or scans.
    [[nodiscard]] std::uint32_t full_steps() const noexcept { return full_steps_; }

private:
    static constexpr std::size_t kChunk = 4096;
    /// Bytes between two checks of the number of scans: three of the smallest.
    static constexpr std::size_t kPiece = 128;
    static constexpr std::uint32_t kPortIds = 0x03000000;
    static constexpr std::uint32_t kLinkIds = 0x03020000;  ///< 256 sensors * 512 bins behind

    struct Tee final : link::CloudSink {
        explicit Tee(link::CloudSink& image) noexcept : to(image) {}
        void begin_scan(const link::CloudScan& scan) noexcept override;
        void add(link::Ray ray, const Vec3& point) noexcept override;
        void end_scan(std::uint32_t points_lost) noexcept override;
        link::CloudSink& to;
        link::CloudSink* also = nullptr;
        bool also_open = false;  ///< a taker that comes amid a scan waits for the next
    };

    hal::SerialPort* port_;
    link::cloud::Receiver receiver_;
    CloudObstacles port_image_{kPortIds};
    CloudObstacles link_image_{kLinkIds};
    Tee port_tee_{port_image_};
    Tee link_tee_{link_image_};
    std::uint64_t bytes_in_ = 0;
    std::uint32_t full_steps_ = 0;
    std::array<std::byte, kChunk> chunk_{};
    std::size_t chunk_begin_ = 0;  ///< read, not yet taken
    std::size_t chunk_end_ = 0;
};

}  // namespace jink::app
