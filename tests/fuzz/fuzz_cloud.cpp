// SPDX-License-Identifier: BSD-3-Clause
// The cloud line from bytes to obstacles. First input byte: 1 repair checksums. Then records: time step in units of
// 10 ms, length, bytes. Checked after each record: rays come in the order of their scans, finite and of the right
// length, every byte and point is in one place, work is bounded, and obstacles are sound.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "firmware/app/cloud.hpp"
#include "firmware/link/cloud/receiver.hpp"
#include "firmware/link/mavlink/checksum.hpp"
#include "tests/fuzz/check.hpp"

using namespace jink;
using namespace jink::link;

namespace {

/// Checks the data that pass through it.
struct Gauge final : CloudSink {
    explicit Gauge(CloudSink& sink) : to(sink) {}
    void begin_scan(const CloudScan& scan) noexcept override
    {
        JINK_FUZZ_CHECK(!open && scan.stamp <= now && scan.max_range > 0.0F && scan.max_range < 656.0F);
        JINK_FUZZ_CHECK(now - scan.stamp <= cloud::Receiver::kMaxAge);
        JINK_FUZZ_CHECK(scan.ray_pitch_level >= 0.0F && scan.ray_pitch_level < 0.66F);
        open = true;
        to.begin_scan(scan);
    }
    void add(Ray ray, const Vec3& point) noexcept override
    {
        JINK_FUZZ_CHECK(open && is_finite(point));
        const float length = point.norm();
        JINK_FUZZ_CHECK(ray == Ray::hit ? length > 0.009F && length < 655.4F : std::abs(length - 1.0F) < 1e-4F);
        ++points;
        to.add(ray, point);
    }
    void end_scan(std::uint32_t points_lost) noexcept override
    {
        JINK_FUZZ_CHECK(open && points_lost <= cloud::kMaxParts * cloud::kMaxPoints);
        open = false;
        to.end_scan(points_lost);
    }
    CloudSink& to;
    TimePoint now;
    bool open = false;
    std::uint64_t points = 0;
};

/// Corrects both checksums of everything that starts like a frame, as far as present.
void repair(std::vector<std::byte>& bytes)
{
    const auto put = [&](std::size_t from, std::size_t at) {
        mavlink::Checksum checksum;
        checksum.add(std::span<const std::byte>(bytes).subspan(from + 2, at - from - 2));
        bytes[at] = static_cast<std::byte>(checksum.value() & 0xFFU);
        bytes[at + 1] = static_cast<std::byte>(checksum.value() >> 8U);
    };
    for (std::size_t p = 0; p + cloud::kHeaderSize <= bytes.size(); ++p) {
        if (bytes[p] != cloud::kSync[0] || bytes[p + 1] != cloud::kSync[1]) {
            continue;
        }
        put(p, p + cloud::kHeaderSize - cloud::kChecksumSize);
        const std::size_t size = cloud::frame_size(std::to_integer<std::size_t>(bytes[p + 12]));
        if (p + size <= bytes.size()) {
            put(p, p + size - cloud::kChecksumSize);
            p += size - 1;
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const auto receiver = std::make_unique<cloud::Receiver>();
    const auto image = std::make_unique<app::CloudObstacles>(0);
    const auto table = std::make_unique<world::ObstacleTable>();
    image->give_to(*table);
    app::CloudView view;
    view.is_placed = true;
    view.half_extents = Vec3(1, 1, 1);
    view.has_floor = (data[0] & 2U) != 0;
    view.floor = -10.0F;
    Gauge gauge(*image);
    gauge.now = TimePoint{10'000'000};
    std::uint64_t heard = 0;
    std::uint64_t calls = 0;
    for (std::size_t at = 1; at + 2 <= size; ++calls) {
        gauge.now.us += 10'000 * std::int64_t{data[at]};
        const std::size_t n = std::min<std::size_t>(4U * data[at + 1], size - at - 2);
        std::vector<std::byte> bytes(n);
        if (n > 0) {
            std::memcpy(bytes.data(), data + at + 2, n);
        }
        at += 2 + n;
        if ((data[0] & 1U) != 0) {
            repair(bytes);
        }
        view.stamp = gauge.now;
        image->look_from(view);
        receiver->receive(bytes, gauge.now, gauge);
        heard += n;
        const cloud::ReceiverDiagnostics& d = receiver->diagnostics();
        JINK_FUZZ_CHECK(d.frame_bytes + d.noise_bytes + receiver->pending() == heard);
        JINK_FUZZ_CHECK(receiver->pending() < cloud::kMaxFrame);
        JINK_FUZZ_CHECK(receiver->is_scan_open() == gauge.open);
        JINK_FUZZ_CHECK(gauge.open ? d.points <= gauge.points : d.points == gauge.points);
        // A frame may be searched anew when a silent line gives it up.
        JINK_FUZZ_CHECK(receiver->checksum_bytes() <=
                        2 * (cloud::Receiver::kMaxWorkPerByte * heard + cloud::kHeaderSize * (calls + 1)));
        const app::CloudDiagnostics& c = image->diagnostics();
        JINK_FUZZ_CHECK(c.hits == c.body + c.below_floor + c.beyond + c.kept);
        JINK_FUZZ_CHECK(table->diagnostics().invalid == 0);
        for (const world::Obstacle& o : table->obstacles()) {
            JINK_FUZZ_CHECK(o.shape.half.maxCoeff() >= 0.249F && o.shape.half.maxCoeff() < 1300.0F);
        }
    }
    return 0;
}
