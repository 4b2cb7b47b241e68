// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step when control is lost by a fault of ours: reports made once, reports repeated until received, and a
// non-finite command.
#include <algorithm>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

constexpr auto kBrake = static_cast<float>(wire::kCopterBrake);

bool has_control(const StepReport& report) { return report.control == Control::ours; }

class CoprocessorLoss : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
        f->fly(60);
        f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
        ASSERT_TRUE(f->until(has_control));
        f->fly(10);
        f->requested.clear();
    }
    [[nodiscard]] std::size_t holds() const
    {
        return static_cast<std::size_t>(std::count(f->requested.begin(), f->requested.end(), kBrake));
    }

    std::unique_ptr<Flight> f = std::make_unique<Flight>();
};

TEST_F(CoprocessorLoss, SaysCriticalOnceAndAsksToHold)
{
    f->own_state = false;
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults != 0; }, 100));
    const auto beats = f->said_of<Heartbeat>();
    ASSERT_EQ(beats.size(), 1U);
    EXPECT_EQ(beats[0].system_status, static_cast<std::uint8_t>(link::SystemState::critical));
    EXPECT_EQ(holds(), 1U);
    EXPECT_EQ(f->mode, wire::kCopterBrake);
    f->fly(200);
    EXPECT_EQ(holds(), 1U) << "seen, so not asked for again";
}

TEST_F(CoprocessorLoss, AsksAgainWhenTheRequestWasNotHeeded)
{
    f->obeys = false;  // the frame is lost in transit
    f->own_state = false;
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults != 0; }, 100));
    f->fly(30);
    EXPECT_EQ(holds(), 2U);
    f->obeys = true;
    f->fly(60);
    EXPECT_EQ(f->mode, wire::kCopterBrake);
    const std::size_t asked = holds();
    f->fly(300);
    EXPECT_EQ(holds(), asked);
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().hold_requests, asked);
}

TEST_F(CoprocessorLoss, DoesNotFightThePilot)
{
    f->obeys = false;
    f->own_state = false;
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults != 0; }, 100));
    f->mode = 0U;  // STABILIZE
    f->fly(1);
    const std::size_t asked = holds();
    f->fly(300);
    EXPECT_EQ(holds(), asked);
}

TEST_F(CoprocessorLoss, AsksOnceTheLineIsBack)
{
    f->port.state = hal::PortState::lost;
    f->fly(100);
    EXPECT_EQ(holds(), 0U);
    f->own_state = false;
    f->port.state = hal::PortState::open;
    f->fly(10);
    EXPECT_EQ(holds(), 1U) << "one HEARTBEAT, asked for, must show that the external mode still stands";
}

TEST_F(CoprocessorLoss, PilotWhoTookOverWhileTheLineWasLostIsNotAskedToHold)
{
    f->port.state = hal::PortState::lost;
    f->fly(100);
    f->mode = 0U;  // STABILIZE
    f->own_state = false;
    f->port.state = hal::PortState::open;
    f->fly(300);
    EXPECT_EQ(holds(), 0U);
}

/// A link that breaks its promise: every number in the inbox is finite.
class LyingLink final : public link::Link {
public:
    explicit LyingLink(link::Link& honest) : honest_(honest) {}
    void receive(std::span<const std::byte> bytes, TimePoint now, link::Inbox& inbox) noexcept override
    {
        honest_.receive(bytes, now, inbox);
        if (lies && inbox.has_own_state) {
            inbox.own_state.state.velocity.x() = std::numeric_limits<float>::quiet_NaN();
        }
    }
    void service(TimePoint now) noexcept override { honest_.service(now); }
    void ask_for_rates(bool on) noexcept override { honest_.ask_for_rates(on); }
    void report_points_to(link::CloudSink& sink) noexcept override { honest_.report_points_to(sink); }
    std::span<const std::byte> pending() const noexcept override { return honest_.pending(); }
    void consume(std::size_t n) noexcept override { honest_.consume(n); }
    void discard_pending() noexcept override { honest_.discard_pending(); }
    void drop_setpoint() noexcept override { honest_.drop_setpoint(); }
    void drop_mode_request() noexcept override { honest_.drop_mode_request(); }
    void send_heartbeat(link::SystemState state) noexcept override { honest_.send_heartbeat(state); }
    void send_velocity(const Vec3& velocity, TimePoint now) noexcept override { honest_.send_velocity(velocity, now); }
    void send_collision(const link::CollisionWarning& warning) noexcept override { honest_.send_collision(warning); }
    void send_text(link::Severity severity, std::string_view text) noexcept override
    {
        honest_.send_text(severity, text);
    }
    void send_param(const link::ParamName& name, float value, std::uint16_t index,
                    std::uint16_t count) noexcept override
    {
        honest_.send_param(name, value, index, count);
    }
    void acknowledge(const link::CommandRequest& request, link::CommandResult result) noexcept override
    {
        honest_.acknowledge(request, result);
    }
    void acknowledge(const link::ConstraintPart& part, link::ConstraintResult result) noexcept override
    {
        honest_.acknowledge(part, result);
    }
    void send_version(const link::Version& version) noexcept override { honest_.send_version(version); }
    bool send_log(const link::LogPart& part) noexcept override { return honest_.send_log(part); }
    void request_external_mode() noexcept override { honest_.request_external_mode(); }
    void request_mode(std::uint32_t mode) noexcept override { honest_.request_mode(mode); }
    void request_heartbeat() noexcept override { honest_.request_heartbeat(); }
    void request_hold_mode() noexcept override { honest_.request_hold_mode(); }
    std::optional<link::GlobalPosition> origin() const noexcept override { return honest_.origin(); }
    std::size_t compose_last_words(std::span<std::byte> out, bool hold, std::string_view text) noexcept override
    {
        return honest_.compose_last_words(out, hold, text);
    }
    const link::LinkDiagnostics& diagnostics() const noexcept override { return honest_.diagnostics(); }

    bool lies = false;

private:
    link::Link& honest_;
};

TEST(CoprocessorNotFinite, IsWithheldCountedAndEndsControl)
{
    const auto f = std::make_unique<Flight>();
    LyingLink liar(f->endpoint);
    const auto c = std::make_unique<Coprocessor>(liar, f->port, f->watchdog, Parameters{});
    const auto tick = [&] {
        f->prepare();
        f->last = c->step(f->now);
        f->react();
    };
    for (int i = 0; i < 200; ++i) {
        tick();
    }
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    for (int i = 0; i < 600 && f->last.control != Control::ours; ++i) {
        tick();
    }
    ASSERT_EQ(f->last.control, Control::ours);
    EXPECT_EQ(c->diagnostics().setpoints_withheld, 0U);
    const int setpoints = f->setpoints;
    const int fed = f->watchdog.fed;
    f->requested.clear();
    liar.lies = true;
    tick();
    EXPECT_NE(f->last.faults & static_cast<std::uint16_t>(Fault::not_finite), 0);
    EXPECT_EQ(f->last.state, link::SystemState::critical);
    EXPECT_FALSE(f->last.setpoint_sent);
    EXPECT_EQ(c->diagnostics().setpoints_withheld, 1U);
    EXPECT_EQ(c->takeover_diagnostics().lost_by_fault, 1U);
    EXPECT_EQ(f->requested, std::vector<float>(1, kBrake));
    EXPECT_EQ(f->watchdog.fed, fed) << "a program that computes nonsense is to be restarted";
    for (int i = 0; i < 20; ++i) {
        tick();
    }
    EXPECT_EQ(f->setpoints, setpoints);
    EXPECT_EQ(f->watchdog.fed, fed);
}

}  // namespace
}  // namespace jink::app::test
