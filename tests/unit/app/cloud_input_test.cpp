// SPDX-License-Identifier: BSD-3-Clause
// Point cloud input: a step's share of an endless port, and causes that spoil a direction.
#include "firmware/app/cloud_input.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/app/cloud_image_bench.hpp"
#include "tests/unit/link/cloud_tools.hpp"

namespace jink::app {
namespace {

/// Gives `part` bytes a read, for ever.
struct EndlessPort final : hal::SerialPort {
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), part);
        std::fill_n(into.begin(), n, std::byte{0});
        given += n;
        return n;
    }
    std::size_t write(std::span<const std::byte> /*from*/) noexcept override { return 0; }
    hal::PortHealth health() const noexcept override { return {}; }
    std::size_t part = 1000;
    std::size_t given = 0;
};

TEST(CloudPort, AStepReadsItsShareAndNoByteMore)
{
    for (const std::size_t part : {1000U, 4096U, 100'000U, 4095U}) {
        EndlessPort port;
        port.part = part;
        const auto input = std::make_unique<CloudInput>(&port);
        EXPECT_TRUE(input->has_port());
        input->serve({1'000'000}, {});
        EXPECT_EQ(port.given, kMaxCloudBytesPerStep) << part;
        EXPECT_EQ(input->bytes_in(), kMaxCloudBytesPerStep);
        EXPECT_EQ(input->full_steps(), 1U);
        port.part = 0;
        input->serve({1'020'000}, {});
        EXPECT_EQ(input->bytes_in(), kMaxCloudBytesPerStep);
        EXPECT_EQ(input->full_steps(), 1U);
    }
    EXPECT_FALSE(std::make_unique<CloudInput>()->has_port());
}

/// Gives what it holds.
struct FilledPort final : hal::SerialPort {
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), bytes.size() - given);
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(given), n, into.begin());
        given += n;
        return n;
    }
    std::size_t write(std::span<const std::byte> /*from*/) noexcept override { return 0; }
    hal::PortHealth health() const noexcept override { return {}; }
    std::vector<std::byte> bytes;
    std::size_t given = 0;
};

/// The end of a scan is costly, and the smallest has 42 bytes: what is left waits for the next step.
TEST(CloudPort, AStepEndsFewScans)
{
    link::cloud::test::Driver driver;
    FilledPort port;
    constexpr std::uint32_t kScans = 100;
    for (std::uint32_t i = 0; i < kScans; ++i) {
        const auto frames = driver.scan(std::vector<link::cloud::RawPoint>{{0, 0, 2000}}, 1000 + i);
        port.bytes.insert(port.bytes.end(), frames[0].begin(), frames[0].end());
    }
    const auto input = std::make_unique<CloudInput>(&port);
    TimePoint now{1'000'000};
    std::uint32_t before = 0;
    std::uint32_t steps = 0;
    for (; input->receiver_diagnostics().scans < kScans && steps < kScans; ++steps, now = now + 0.02F) {
        input->serve(now, {});
        EXPECT_LE(input->receiver_diagnostics().scans - before, 8U);
        before = input->receiver_diagnostics().scans;
    }
    EXPECT_EQ(before, kScans);
    EXPECT_LE(steps, kScans / 4);
    EXPECT_GE(input->full_steps(), steps - 1);
    EXPECT_EQ(input->bytes_in(), port.bytes.size());
    EXPECT_EQ(input->receiver_diagnostics().noise_bytes, 0U);
}

class SpoiledDirections : public test::CloudImageBench {
protected:
    SpoiledDirections()
    {
        view.half_extents = Vec3(2.0F, 1.5F, 1.0F);
        look();
    }
};

/// A part of the own vehicle in front does not remove hits beside it.
TEST_F(SpoiledDirections, AHitOfTheBodyDoesNotHideAnotherHit)
{
    EXPECT_EQ(scan({at(1.0F, 1.0F, 20.0F), at(1.5F, 1.5F, 0.5F)}), 1U);
    EXPECT_TRUE(is_covered(at(1.0F, 1.0F, 20.0F)));
    EXPECT_EQ(scan({at(1.5F, 1.5F, 0.5F), at(1.0F, 1.0F, 20.0F)}), 1U);
    EXPECT_EQ(count().body, 2U);
    EXPECT_EQ(count().kept, 2U);
}

/// A hit beyond the reach is no reason to keep a removed obstacle.
TEST_F(SpoiledDirections, AnEmptyDirectionStaysEmptyWithAHitBeyondTheReach)
{
    ASSERT_EQ(scan({at(1.0F, 1.0F, 20.0F)}), 1U);
    begin();
    image->add(link::Ray::nothing, at(1.0F, 1.0F, 1.0F));
    image->add(link::Ray::hit, at(1.5F, 1.5F, 700.0F));
    image->end_scan(0);
    EXPECT_EQ(obstacles().size(), 0U);
    EXPECT_EQ(count().beyond, 1U);
    // A hit of the body hides the space behind: obstacles there stay.
    ASSERT_EQ(scan({at(1.0F, 1.0F, 20.0F)}), 1U);
    begin();
    image->add(link::Ray::hit, at(1.5F, 1.5F, 0.5F));
    image->add(link::Ray::nothing, at(1.0F, 1.0F, 1.0F));
    image->end_scan(0);
    EXPECT_EQ(obstacles().size(), 1U);
}

}  // namespace
}  // namespace jink::app
