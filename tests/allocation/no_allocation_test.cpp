// SPDX-License-Identifier: BSD-3-Clause
// Flies every state of the supervisor through Coprocessor::step and counts allocations: must be zero. malloc and
// related functions are replaced for the whole process, shared libraries included, and forwarded to glibc's own
// entries; operator new is replaced too, so that the origin of an allocation is visible.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>

#include "tests/unit/app/cloud_bench.hpp"

extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT: glibc's names
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* old, std::size_t size);               // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT
void __libc_free(void* memory);                                  // NOLINT
}

namespace {

bool armed = false;
long by_malloc = 0;
long by_new = 0;

void count(long& counter) noexcept { counter += armed ? 1 : 0; }

void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t))
{
    count(by_new);
    void* memory = __libc_memalign(alignment, size);
    if (memory == nullptr) {
        std::abort();
    }
    return memory;
}

}  // namespace

extern "C" {
void* malloc(std::size_t size) noexcept
{
    count(by_malloc);
    return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) noexcept
{
    count(by_malloc);
    return __libc_calloc(n, size);
}
void* realloc(void* old, std::size_t size) noexcept
{
    count(by_malloc);
    return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept
{
    count(by_malloc);
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept
{
    count(by_malloc);
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept
{
    count(by_malloc);
    *out = __libc_memalign(alignment, size);
    return *out != nullptr ? 0 : ENOMEM;
}
void free(void* memory) noexcept { __libc_free(memory); }
}

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void* operator new(std::size_t size, std::align_val_t a) { return allocate(size, static_cast<std::size_t>(a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return allocate(size, static_cast<std::size_t>(a)); }
void operator delete(void* memory) noexcept { __libc_free(memory); }
void operator delete[](void* memory) noexcept { __libc_free(memory); }
void operator delete(void* memory, std::size_t) noexcept { __libc_free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { __libc_free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { __libc_free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { __libc_free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { __libc_free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { __libc_free(memory); }

namespace {

using namespace jink;
using namespace jink::app::test;

int failures = 0;

void expect(bool holds, const char* what)
{
    if (!holds) {
        ++failures;
        std::printf("FAILED: %s\n", what);
    }
}

/// The hooks are valid only if they detect every kind of allocation.
void check_the_hooks()
{
    const auto counted = [](auto allocation) {
        const long before = by_malloc + by_new;
        armed = true;
        void* volatile memory = allocation();
        armed = false;
        __libc_free(memory);
        return by_malloc + by_new - before == 1;
    };
    expect(counted([] { return std::malloc(24); }), "malloc is counted");
    expect(counted([] { return std::calloc(3, 8); }), "calloc is counted");
    expect(counted([] { return std::realloc(nullptr, 24); }), "realloc is counted");
    expect(counted([] { return std::aligned_alloc(64, 64); }), "aligned_alloc is counted");
    expect(counted([] { return ::operator new(24); }), "operator new is counted");
    expect(counted([] { return ::operator new[](24); }), "operator new[] is counted");
    expect(counted([] { return ::operator new (64, std::align_val_t{64}); }), "aligned operator new is counted");
    // Not called by this program itself but within the C library.
    expect(counted([]() -> void* { return ::strdup("jink"); }), "an allocation inside a library is counted");
    by_malloc = by_new = 0;
}

struct Visited {
    long steps = 0;
    long quiet = 0;
    long avoiding = 0;
    long braking = 0;
    long rejoining = 0;
    long in_control = 0;
    long given_back = 0;
    long parameters = 0;
    long refused_bytes = 0;
    long neighbours = 0;
};

class Watched {
public:
    Watched() { flight.coprocessor.use_clouds(clouds); }
    void fly(int ticks)
    {
        for (int i = 0; i < ticks; ++i) {
            tick();
        }
    }
    template <class Done>
    void until(Done done, int limit, const char* what)
    {
        for (int i = 0; i < limit; ++i) {
            if (done(tick())) {
                return;
            }
        }
        expect(false, what);
    }

    app::StepReport tick()
    {
        flight.prepare();
        armed = true;
        const app::StepReport report = flight.step();
        armed = false;
        flight.react();
        const bool ours = report.control == app::Control::ours;
        const avoid::State state = report.guidance.state;
        ++visited.steps;
        visited.quiet += !report.guidance.conflict.has_value() && report.control == app::Control::autopilot ? 1 : 0;
        visited.avoiding += ours && state == avoid::State::avoiding ? 1 : 0;
        visited.braking += ours && state == avoid::State::braking ? 1 : 0;
        visited.rejoining += ours && state == avoid::State::rejoining ? 1 : 0;
        visited.in_control += ours ? 1 : 0;
        visited.parameters += static_cast<long>(flight.said_of<ParamValue>().size());
        return report;
    }

    CloudLine line;
    app::CloudInput clouds{&line};
    Flight flight;
    Visited visited;
};

void fly_everything(Watched& w)
{
    const auto in_control = [](const app::StepReport& r) { return r.control == app::Control::ours; };
    const auto own_way = [](const app::StepReport& r) { return r.control == app::Control::autopilot; };
    Flight& f = w.flight;
    w.fly(200);

    ParamRequestList list;
    list.target_system = wire::kSystem;
    list.target_component = wire::kUs;
    f.feed(list);
    w.fly(40);

    Random random(1);
    for (int i = 0; i < 50; ++i) {
        f.feed_bytes(wire::random_bytes(random, 600));
        w.tick();
    }
    w.fly(50);

    // Point clouds of a LiDAR, damaged ones too.
    cloud::test::Driver driver;
    for (int i = 0; i < 20; ++i) {
        f.feed(wire::attitude(f.boot_ms(), 0.5F * kPi));
        auto bytes = cloud::test::joined(driver.scan(cloud::test::random_points(random, 5000), 100U * driver.number));
        bytes[random.below(bytes.size())] ^= std::byte{1};
        w.line.feed(bytes);
        w.fly(5);
    }
    w.fly(60);

    // Around a pillar and back.
    f.obstacles = {f.position + Vec3(0.4F, 40.0F, 0.0F)};
    w.until(in_control, 1000, "takes over for an obstacle in the way");
    w.until(own_way, 3000, "gives back behind it");
    f.obstacles.clear();
    w.fly(400);

    // Shut in from one tick to the next: nothing is safe.
    f.ring = 4.0F;
    w.until([](const app::StepReport& r) { return r.guidance.state == avoid::State::braking; }, 300, "brakes, shut in");
    w.fly(100);
    f.ring = 0.0F;
    w.until(own_way, 1500, "gives back once free");
    w.fly(100);

    // Other systems of the link, and their reports to traffic management.
    for (int i = 0; i < 200; ++i) {
        GlobalPositionInt m;
        m.time_boot_ms = f.boot_ms();
        m.lat = 473977420 + i;
        m.lon = 85455940 + 20'000;
        m.alt = 538000;
        UtmGlobalPosition utm;
        utm.lat = m.lat;
        utm.lon = m.lon;
        utm.alt = m.alt;
        utm.uas_id.fill(static_cast<std::uint8_t>(i));
        utm.flags = 2 | 4 | 8 | 32 | 64;
        const auto system = static_cast<std::uint8_t>(10 + i);
        f.feed_bytes(wire::frame_of(wire::heartbeat(3, i % 2 == 0, 3), {system, 1, 0}));
        f.feed_bytes(wire::frame_of(m, {system, 1, 1}));
        f.feed_bytes(wire::frame_of(utm, {system, 1, 2}));
        w.fly(1);
    }
    w.visited.neighbours = static_cast<long>(f.coprocessor.tracks(f.now).size());
    w.fly(200);

    // A full house.
    for (int i = 0; i < static_cast<int>(kMaxTracks) + 8; ++i) {
        f.obstacles.push_back(f.position + Vec3(random.uniform(-15.0F, 15.0F), 45.0F, random.uniform(-8.0F, 8.0F)));
    }
    w.fly(600);
    w.visited.given_back = static_cast<long>(f.coprocessor.takeover_diagnostics().given_back);
    w.visited.refused_bytes = static_cast<long>(f.endpoint.parser_diagnostics().noise_bytes);
}

}  // namespace

int main()
{
    check_the_hooks();
    const auto watched = std::make_unique<Watched>();
    fly_everything(*watched);
    const Visited& v = watched->visited;
    std::printf("steps %ld: quiet %ld, in control %ld, avoiding %ld, braking %ld, rejoining %ld, given back %ld, "
                "parameters %ld, noise bytes %ld\n",
                v.steps, v.quiet, v.in_control, v.avoiding, v.braking, v.rejoining, v.given_back, v.parameters,
                v.refused_bytes);
    std::printf("allocations within step: %ld by malloc and kin, %ld by operator new\n", by_malloc, by_new);
    expect(by_malloc == 0, "no malloc within step");
    expect(by_new == 0, "no operator new within step");
    expect(v.quiet > 200, "quiet flight was visited");
    expect(v.avoiding > 0, "avoiding was visited in control");
    expect(v.braking > 0, "braking was visited in control");
    expect(v.rejoining > 0, "rejoining was visited in control");
    expect(v.given_back >= 2, "control was given back twice");
    expect(v.parameters == static_cast<long>(app::kParamCount), "the whole parameter list went out");
    expect(v.neighbours == static_cast<long>(kMaxTracks), "neighbours filled the table");
    expect(v.refused_bytes > 20000, "garbage was searched and refused");
    expect(watched->clouds.port_diagnostics().obstacles > 0, "clouds became obstacles");
    expect(!watched->flight.lost_input, "the port held everything that was fed");
    return failures == 0 ? 0 : 1;
}
