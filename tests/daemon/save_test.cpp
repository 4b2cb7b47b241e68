// SPDX-License-Identifier: BSD-3-Clause
// jinkd's answer to "save" of a DroneCAN tool: the true state of its state file. The test calls the control loop's
// side; the writing thread is the daemon's own.
#include <memory>

#include "firmware/linux/housekeeping.hpp"
#include "tests/daemon/harness.hpp"

namespace {

using namespace jink;
using test::Scratch;

class SilentPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> /*into*/) noexcept override { return 0; }
    std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    hal::PortHealth health() const noexcept override { return {}; }
};

class NoWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override {}
};

/// A bus that does nothing but hold who answers for parameters.
class ServedBus final : public link::SensorBus {
public:
    void receive(TimePoint /*now*/, link::Inbox& /*inbox*/) noexcept override {}
    void service(TimePoint /*now*/, const link::BusStatus& /*status*/) noexcept override {}
    bool is_lost() const noexcept override { return false; }
    void follow_origin(const std::optional<link::GlobalPosition>& /*origin*/) noexcept override {}
    void serve(link::ParamServer& server) noexcept override { params = &server; }
    void send_text(link::Severity /*severity*/, std::string_view /*text*/) noexcept override {}
    bool send_near(const link::NearObject& /*object*/) noexcept override { return false; }

    link::ParamServer* params = nullptr;
};

constexpr auto kTrackAge = static_cast<std::uint16_t>(app::Param::track_age);

class DaemonSave : public testing::Test {
protected:
    SilentPort port;
    NoWatchdog watchdog;
    ServedBus bus;
    link::mavlink::Signing signing;
    link::mavlink::Endpoint endpoint;
    std::unique_ptr<app::Coprocessor> coprocessor =
        std::make_unique<app::Coprocessor>(endpoint, port, watchdog, app::Parameters(), &bus);
    Scratch scratch;
    TimePoint now{1'000'000};

    /// Steps of housekeeping until `save` is answered yes, 5 s at most.
    bool is_saved(host::Housekeeping& housekeeping, int steps = 500)
    {
        for (int i = 0; i < steps; ++i) {
            housekeeping.work(now);
            if (bus.params->save()) {
                return true;
            }
            std::this_thread::sleep_for(test::milliseconds(10));
        }
        return false;
    }
    [[nodiscard]] std::string text(const std::string& name) const
    {
        std::ifstream file(scratch / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
};

TEST_F(DaemonSave, IsAnsweredYesOnceTheStateFileHoldsTheValues)
{
    host::Background background({"", (scratch / "state").string(), "", coprocessor->initial_parameters()});
    host::Housekeeping housekeeping(background, *coprocessor, endpoint, signing, {});
    for (const float age : {9.0F, 10.0F, 11.0F}) {
        bus.params->write(kTrackAge, age);
        EXPECT_FALSE(bus.params->save()) << "not before it was handed over";
        ASSERT_TRUE(is_saved(housekeeping)) << age;
        EXPECT_NE(text("state").find("TRK_AGE," + std::to_string(static_cast<int>(age))), std::string::npos);
    }
    EXPECT_TRUE(bus.params->erase());
    EXPECT_FALSE(bus.params->save());
    ASSERT_TRUE(is_saved(housekeeping));
    EXPECT_EQ(text("state").find("TRK_AGE"), std::string::npos);
}

TEST_F(DaemonSave, IsAnsweredNoWhereNothingCanBeStored)
{
    for (const char* const state : {"", "none/state"}) {
        const std::string path = *state == '\0' ? "" : (scratch / state).string();
        host::Background background({"", path, "", coprocessor->initial_parameters()});
        host::Housekeeping housekeeping(background, *coprocessor, endpoint, signing, {});
        bus.params->write(kTrackAge, 9.0F);
        EXPECT_FALSE(is_saved(housekeeping, 30)) << state;
    }
}

}  // namespace
