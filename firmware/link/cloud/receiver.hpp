// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/link/cloud.hpp"
#include "firmware/link/cloud/frame.hpp"
#include "firmware/link/mavlink/clock_sync.hpp"

namespace jink::link::cloud {

/// What a receiver received, lost and refused, one counter per cause. 32-bit counters wrap.
///
/// Every received byte is counted in `frame_bytes` or `noise_bytes`, or is still pending. Every point of a scan that
/// has begun is counted in `points` or `points_lost`.
struct ReceiverDiagnostics {
    std::uint64_t frame_bytes = 0;  ///< of whole frames with correct checksums, refused or not
    std::uint64_t noise_bytes = 0;  ///< between them
    std::uint64_t points = 0;       ///< passed to the sink
    std::uint64_t points_lost = 0;
    std::uint32_t frames = 0;  ///< accepted
    std::uint32_t scans = 0;   ///< begun
    std::uint32_t scans_complete = 0;
    std::uint32_t scans_missed = 0;   ///< numbers skipped: scans of which no frame was accepted
    std::uint32_t frames_missed = 0;  ///< numbers skipped
    std::uint32_t reordered = 0;      ///< frames that arrived after a frame sent later
    std::uint32_t restarts = 0;       ///< restarts of the sender's numbers
    std::uint32_t clock_relocks = 0;  ///< jumps of the sender's clock that the mapping followed

    // Possible frames that fail; the search continues within their bytes.
    std::uint32_t unknown_version = 0;
    std::uint32_t bad_header = 0;    ///< checksum of the header
    std::uint32_t bad_checksum = 0;  ///< of the frame
    std::uint32_t cut = 0;           ///< discarded incomplete on a silent line

    // Frames with correct checksums that are refused.
    std::uint32_t out_of_range = 0;  ///< values of a header or of a point outside their range
    std::uint32_t inconsistent = 0;  ///< with the other frames of the scan
    std::uint32_t duplicated = 0;
    std::uint32_t late = 0;   ///< of a scan that has ended
    std::uint32_t stale = 0;  ///< stamped too long ago, or in the future
};

/// Finds the frames of one sender in a stream of bytes and passes their points on, level and in metres.
///
/// One scan is open at a time. A frame of another scan or sensor ends the scan, and so do its last missing part and a
/// line silent for kScanPause. Parts may come in any order. After noise or a damaged frame the search continues one
/// byte after a false start, or right after a header whose checksum is correct. So a good frame within the bytes that a
/// damaged frame claimed is found.
///
/// The sender's stamps are mapped to our clock by their arrival; the least delay observed counts as zero. The least
/// time from a scan's stamp to the line is not observable, and makes the scan appear that much younger. After 10 s
/// without a scan the clock is mapped anew: the sender may have restarted.
///
/// Work: at most kMaxWorkPerByte bytes through a checksum per byte, and a header more per call; per point a sine and a
/// cosine of each angle. Nothing is allocated. Memory: 2 * kMaxFrame + kMaxParts / 8 bytes, 430 for the clock and the
/// counters.
class Receiver {
public:
    /// A header's checksum per false start, at most one for every second byte, and a frame's per correct header.
    static constexpr std::size_t kMaxWorkPerByte = kHeaderSize / 2 + kMaxFrame / kHeaderSize + 1;
    /// A scan without a frame for this long has ended [s]: two turns of a sensor that turns 10 times a second.
    static constexpr Seconds kScanPause = 0.2F;
    /// A scan older than this is refused [s].
    static constexpr Seconds kMaxAge = 1.0F;

    /// Processes received bytes. Call it without any while the line is silent, so that silence is detected. O(bytes).
    void receive(std::span<const std::byte> bytes, TimePoint now, CloudSink& sink) noexcept;

    [[nodiscard]] std::size_t pending() const noexcept { return end_ - begin_; }
    [[nodiscard]] bool is_scan_open() const noexcept { return open_; }
    [[nodiscard]] const ReceiverDiagnostics& diagnostics() const noexcept { return diagnostics_; }
    /// Bytes that were included in a checksum.
    [[nodiscard]] std::uint64_t checksum_bytes() const noexcept { return checksum_bytes_; }

private:
    void search(TimePoint now, CloudSink& sink) noexcept;
    [[nodiscard]] bool judge(TimePoint now, CloudSink& sink) noexcept;
    void pass_over(std::size_t n) noexcept;
    void take(std::span<const std::byte>& bytes) noexcept;
    void give_up(TimePoint now, CloudSink& sink) noexcept;
    void on_frame(const Part& part, std::span<const std::byte> frame, TimePoint now, CloudSink& sink) noexcept;
    void follow_sequence(std::uint16_t sequence) noexcept;
    [[nodiscard]] bool is_ours(const Part& part) noexcept;
    [[nodiscard]] bool begin_scan(const Part& part, TimePoint now, CloudSink& sink) noexcept;
    [[nodiscard]] bool stamp_of(const Part& part, TimePoint now, TimePoint& stamp) noexcept;
    void add_points(const Part& part, std::span<const std::byte> frame, CloudSink& sink) noexcept;
    void end_scan(CloudSink& sink) noexcept;

    ReceiverDiagnostics diagnostics_;
    std::uint64_t checksum_bytes_ = 0;
    mavlink::ClockSync clock_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    TimePoint last_byte_;
    TimePoint last_frame_;
    bool has_sequence_ = false;
    std::uint16_t sequence_ = 0;
    bool has_scan_ = false;
    bool open_ = false;
    Part scan_;  ///< first frame of the newest scan
    bool has_stamped_ = false;
    Part stamped_;  ///< newest scan whose stamp has been passed to the clock
    TimePoint stamped_at_;
    std::uint32_t scan_points_ = 0;
    std::uint16_t scan_parts_ = 0;
    Mat3 level_ = Mat3::Identity();  ///< platform, with y left and z up, to level
    std::array<std::uint8_t, kMaxParts / 8> received_{};
    std::array<std::byte, 2 * kMaxFrame> buffer_{};
};

}  // namespace jink::link::cloud
