// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/cloud/receiver.hpp"

#include <algorithm>

namespace jink::link::cloud {
namespace {

/// A line without a byte for this long is not in the middle of a frame [s].
constexpr Seconds kSilence = 0.1F;
/// A stamp may be this far ahead of our clock: resolution of the wire and of the clock mapping [s].
constexpr Seconds kFutureSlack = 0.03F;
/// Numbers that step back by no more than this were overtaken in transfer; a larger step back is a restart of the
/// sender.
constexpr int kFramesOvertaken = 64;
constexpr int kScansOvertaken = 8;
/// Numbers that step forward by more than this are a restart of the sender.
constexpr int kMaxMissed = 1000;

[[nodiscard]] int step_between(std::uint16_t from, std::uint16_t to) noexcept
{
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

[[nodiscard]] bool is_same_scan(const Part& a, const Part& b) noexcept
{
    return a.sensor == b.sensor && a.scan == b.scan;
}

[[nodiscard]] bool agrees(const Part& a, const Part& b) noexcept
{
    return a.parts == b.parts && a.max_range == b.max_range && a.stamp_ms == b.stamp_ms && a.roll == b.roll &&
           a.pitch == b.pitch && a.ray_pitch_level == b.ray_pitch_level &&
           a.ray_pitch_vertical == b.ray_pitch_vertical && a.scan_points == b.scan_points;
}

[[nodiscard]] bool is_possible(const RawPoint& point) noexcept
{
    return point.azimuth >= -kHalfTurn && point.azimuth <= kHalfTurn && point.elevation >= -kQuarterTurn &&
           point.elevation <= kQuarterTurn;
}

}  // namespace

void Receiver::receive(std::span<const std::byte> bytes, TimePoint now, CloudSink& sink) noexcept
{
    const bool silent = bytes.empty() && now - last_byte_ > kSilence;
    last_byte_ = bytes.empty() ? last_byte_ : now;
    search(now, sink);
    while (!bytes.empty()) {  // `take` removes at least one byte per turn
        take(bytes);
        search(now, sink);
    }
    if (silent) {
        give_up(now, sink);
    }
    if (open_ && now - last_frame_ > kScanPause) {
        end_scan(sink);
    }
}

void Receiver::take(std::span<const std::byte>& bytes) noexcept
{
    if (end_ == buffer_.size()) {
        // Less than a frame is pending, so more than half of the buffer is free: at most one byte moves per byte
        // received.
        std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(), buffer_.begin());
        end_ -= begin_;
        begin_ = 0;
    }
    const std::size_t n = std::min(bytes.size(), buffer_.size() - end_);
    std::copy_n(bytes.begin(), n, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
    end_ += n;
    bytes = bytes.subspan(n);
}

void Receiver::pass_over(std::size_t n) noexcept
{
    begin_ += n;
    diagnostics_.noise_bytes += n;
}

/// Searches up to an incomplete frame or the end of the pending bytes.
void Receiver::search(TimePoint now, CloudSink& sink) noexcept
{
    while (pending() > 0) {  // at least one byte is removed per turn
        const bool may_start = buffer_[begin_] == kSync[0];
        const bool is_whole = pending() > kSync.size();  // start bytes and version
        if (!may_start || (is_whole && buffer_[begin_ + 1] != kSync[1])) {
            pass_over(1);
        } else if (!is_whole || !judge(now, sink)) {
            return;
        }
    }
}

/// Checks the bytes after the start bytes. False while the frame is incomplete.
bool Receiver::judge(TimePoint now, CloudSink& sink) noexcept
{
    if (buffer_[begin_ + kSync.size()] != std::byte{kVersion}) {
        ++diagnostics_.unknown_version;
        pass_over(1);
        return true;
    }
    if (pending() < kHeaderSize) {
        return false;
    }
    const auto bytes = std::span<const std::byte>(buffer_).subspan(begin_, pending());
    const std::optional<Part> part = read_header(bytes);
    checksum_bytes_ += kHeaderSize;
    if (!part) {
        ++diagnostics_.bad_header;
        pass_over(1);
        return true;
    }
    if (!is_plausible(*part)) {
        ++diagnostics_.out_of_range;
        pass_over(kHeaderSize);
        return true;
    }
    const std::size_t size = frame_size(part->points);
    if (pending() < size) {
        return false;
    }
    checksum_bytes_ += size;
    if (!checksum_holds(bytes.first(size))) {
        ++diagnostics_.bad_checksum;
        pass_over(kHeaderSize);
        return true;
    }
    diagnostics_.frame_bytes += size;
    on_frame(*part, bytes.first(size), now, sink);
    begin_ += size;
    return true;
}

/// Discards an incomplete frame on a silent line.
void Receiver::give_up(TimePoint now, CloudSink& sink) noexcept
{
    while (pending() > 0) {  // at least one byte is removed per turn
        ++diagnostics_.cut;
        pass_over(1);
        search(now, sink);
    }
}

void Receiver::follow_sequence(std::uint16_t sequence) noexcept
{
    const int step = has_sequence_ ? step_between(sequence_, sequence) : 1;
    if (step <= 0 && step >= -kFramesOvertaken) {
        diagnostics_.reordered += step < 0 ? 1U : 0U;
        return;
    }
    if (step < 0 || step > kMaxMissed) {
        ++diagnostics_.restarts;
    } else {
        diagnostics_.frames_missed += static_cast<std::uint32_t>(step - 1);
    }
    has_sequence_ = true;
    sequence_ = sequence;
}

void Receiver::on_frame(const Part& part, std::span<const std::byte> frame, TimePoint now, CloudSink& sink) noexcept
{
    follow_sequence(part.sequence);
    for (std::size_t i = 0; i < part.points; ++i) {
        if (!is_possible(read_point(frame, i))) {
            ++diagnostics_.out_of_range;
            return;
        }
    }
    if (has_scan_ && is_same_scan(part, scan_)) {
        if (!is_ours(part)) {
            return;
        }
    } else if (!begin_scan(part, now, sink)) {
        return;
    }
    last_frame_ = now;
    ++diagnostics_.frames;
    received_[part.part / 8U] = static_cast<std::uint8_t>(received_[part.part / 8U] | 1U << part.part % 8U);
    add_points(part, frame, sink);
    scan_points_ += part.points;
    if (++scan_parts_ == scan_.parts) {
        end_scan(sink);
    }
}

/// Whether a frame of the current scan adds points to the scan; if not, the cause is counted.
bool Receiver::is_ours(const Part& part) noexcept
{
    std::uint32_t* cause = nullptr;
    const bool is_too_much = open_ && part.points > scan_.scan_points - scan_points_;
    const std::uint32_t received = received_[part.part / 8U];
    if ((received >> part.part % 8U & 1U) != 0 && agrees(part, scan_)) {
        cause = &diagnostics_.duplicated;
    } else if (is_too_much || !agrees(part, scan_)) {
        cause = &diagnostics_.inconsistent;
    } else if (!open_) {
        cause = &diagnostics_.late;
    }
    if (cause != nullptr) {
        ++*cause;
    }
    return cause == nullptr;
}

bool Receiver::stamp_of(const Part& part, TimePoint now, TimePoint& stamp) noexcept
{
    const bool is_new = !has_stamped_ || !is_same_scan(part, stamped_);
    if (is_new && now.us - stamped_at_.us > mavlink::ClockSync::kUnheard) {
        clock_.forget();
    }
    const std::int64_t sent = clock_.extend(part.stamp_ms);
    if (is_new) {  // one sample per scan, whatever the number of its frames
        const mavlink::ClockEvent event = clock_.one_way(sent, now.us);
        diagnostics_.clock_relocks += event != mavlink::ClockEvent::none ? 1U : 0U;
        stamped_ = part;
        stamped_at_ = now;
        has_stamped_ = true;
    }
    stamp = {clock_.to_local(sent).value_or(now.us)};
    if (stamp > now + kFutureSlack || now - stamp > kMaxAge) {
        ++diagnostics_.stale;
        return false;
    }
    stamp = std::min(stamp, now);
    return true;
}

bool Receiver::begin_scan(const Part& part, TimePoint now, CloudSink& sink) noexcept
{
    const bool same_sensor = has_scan_ && part.sensor == scan_.sensor;
    const int step = same_sensor ? step_between(scan_.scan, part.scan) : 1;
    if (step < 0 && step >= -kScansOvertaken) {
        ++diagnostics_.late;
        return false;
    }
    CloudScan scan;
    if (!stamp_of(part, now, scan.stamp)) {
        return false;
    }
    if (open_) {
        end_scan(sink);
    }
    diagnostics_.scans_missed += step > 1 && step <= kMaxMissed ? static_cast<std::uint32_t>(step - 1) : 0U;
    ++diagnostics_.scans;
    has_scan_ = true;
    open_ = true;
    scan_ = part;
    scan_points_ = 0;
    scan_parts_ = 0;
    received_.fill(0);
    level_ = level_of_frd(kAngleUnit * static_cast<float>(part.roll), kAngleUnit * static_cast<float>(part.pitch)) *
             Vec3(1.0F, -1.0F, -1.0F).asDiagonal();
    scan.sensor = part.sensor;
    scan.ray_pitch_level = kPitchUnit * static_cast<float>(part.ray_pitch_level);
    scan.ray_pitch_vertical = kPitchUnit * static_cast<float>(part.ray_pitch_vertical);
    scan.max_range = kRangeUnit * static_cast<float>(part.max_range);
    sink.begin_scan(scan);
    return true;
}

void Receiver::add_points(const Part& part, std::span<const std::byte> frame, CloudSink& sink) noexcept
{
    for (std::size_t i = 0; i < part.points; ++i) {
        const RawPoint raw = read_point(frame, i);
        const float azimuth = kAngleUnit * static_cast<float>(raw.azimuth);
        const float elevation = kAngleUnit * static_cast<float>(raw.elevation);
        const float level = std::cos(elevation);
        const Vec3 direction = level_ * Vec3(level * std::cos(azimuth), level * std::sin(azimuth), std::sin(elevation));
        if (raw.range == kNothingRange) {
            sink.add(Ray::nothing, direction);
        } else if (raw.range == kInvalidRange) {
            sink.add(Ray::invalid, direction);
        } else {
            sink.add(Ray::hit, direction * (kRangeUnit * static_cast<float>(raw.range)));
        }
    }
}

void Receiver::end_scan(CloudSink& sink) noexcept
{
    const std::uint32_t lost = scan_.scan_points - scan_points_;
    open_ = false;
    diagnostics_.points += scan_points_;
    diagnostics_.points_lost += lost;
    diagnostics_.scans_complete += lost == 0 ? 1U : 0U;
    sink.end_scan(lost);
}

}  // namespace jink::link::cloud
