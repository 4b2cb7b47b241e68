// SPDX-License-Identifier: BSD-3-Clause
// Cost of a work unit: one kind of counted work at a time, on random input, and its work units. Requests on the way in,
// answers on the way out; toolchain/report/units counts the instructions of each.
#include <array>
#include <cmath>
#include <cstdint>

#include "core/avoid/common_stop.hpp"
#include "core/avoid/fallback.hpp"
#include "core/avoid/final_check.hpp"
#include "core/avoid/give_way.hpp"
#include "core/avoid/objective.hpp"
#include "core/base/work_units.hpp"
#include "core/cost/tables.hpp"
#include "core/geometric/curve.hpp"
#include "core/geometric/planner.hpp"
#include "core/geometry/convex.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/reach/scan_picture.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/threat_set.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"
#include "tests/target/probe_io.hpp"
#include "tests/target/unit_scene.hpp"
#include "tests/target/window.hpp"

namespace jink::target {
namespace {

constexpr std::uint32_t kMagic = 0x4A555001;
constexpr std::uint32_t kAmple = 100'000'000;

struct Request {
    std::uint32_t magic;
    std::uint32_t seed;
    std::uint32_t work;
};

struct Answer {
    std::uint32_t magic;
    std::uint32_t seed;
    std::uint32_t units;
};

class UnitProbe : private UnitScene {
public:
    std::uint32_t units_of(Work work, std::uint32_t seed) noexcept;

private:
    void geometry(Work work, WorkBudget& budget) noexcept;
    void curve(Work work, WorkBudget& budget) noexcept;
    void program(WorkBudget& budget) noexcept;
    void scan() noexcept;
    void candidates() noexcept;
    [[nodiscard]] std::uint32_t tables(WorkBudget& budget) noexcept;

    world::ThreatSet threats_;
    orca::Planner orca_;
    geometric::Planner geometric_{geometric::Settings()};
    reach::Planner reach_{{.sets = &app::reach_sets()}};
    reach::ScanPicture picture_;
    std::array<orca::HalfSpace, kMaxOrcaPlanes> planes_{};
    orca::Scratch<kMaxOrcaPlanes> scratch_;
    volatile float sink_ = 0.0F;
};

void UnitProbe::geometry(Work work, WorkBudget& budget) noexcept
{
    const Vec3 half = sized(0.2F, 2.0F);
    const Vec3 from = within(5.0F);
    const Vec3 to = from + within(random_.uniform(0.0F, 8.0F));
    const float clearance = below(2) == 0 ? 0.0F : 0.5F;
    const Vec3 at = within(random_.uniform(1.0F, 20.0F));
    const bool closed_form =
        work == Work::contact_closed || work == Work::distance_closed || work == Work::margin_closed;
    const geometry::Shape shape = closed_form ? closed(at) : solid(at);
    jink_window_begin();
    if (work == Work::contact_closed || work == Work::contact_solid) {
        const geometry::Contact contact = geometry::swept_box_contact(half, from, to, shape, clearance, budget);
        sink_ = contact == geometry::Contact::clear ? 1.0F : 0.0F;
    } else if (work == Work::distance_closed || work == Work::distance_solid) {
        sink_ = geometry::swept_box_distance(half, from, to, shape, 20.0F, world::kObstacleResolution, budget);
    } else {
        sink_ = world::obstacle_margin(half, from, to, shape, budget);
    }
    jink_window_end();
}

/// Duration and smoothness of a candidate, or its energy: by its waypoints, as the planner does, and out of the tables.
void UnitProbe::curve(Work work, WorkBudget& budget) noexcept
{
    using namespace geometric;
    const std::uint16_t waypoints = cost::tables::kDefault.waypoints;
    const Family family = below(2) == 0 ? Family::simple : Family::symmetric;
    const float distance = random_.uniform(2.5F, 40.0F);
    const float offset = random_.uniform(-1.28F, 1.28F) * distance;
    constexpr std::array<float, 3> kShares{1.0F, 0.6F, 0.3F};
    const float speed = kShares[below(3)] * limits_.cruise_speed;
    // A level leg in every other case.
    const float climb = below(2) == 0 ? 0.0F : random_.uniform(-1.0F, 1.0F);
    const PathFrame frame = make_path_frame(Vec3::Zero(), Vec3(1.0F, 0.0F, climb));
    const Vec3 along = frame.axes.col(0);
    const Vec3 side = detail::plane_direction(frame, 0.25F * kPi * static_cast<float>(below(4)));
    const detail::UnitCurve unit = detail::make_unit_curve(family, waypoints);
    const cost::tables::CurveQuery query{
        static_cast<std::size_t>(family), offset, distance, speed, along.z(), side.z()};
    detail::Curve made;
    detail::Coordinates y;
    path::TimedPath& timed = manoeuvre_.path;
    jink_window_begin();
    switch (work) {
    case Work::curve_exact:
        static_cast<void>(budget.spend((units::kCandidatePoint + units::kCostPoint) * waypoints));
        detail::make_curve(unit, along, side, distance, offset, speed, limits_, made);
        for (std::size_t i = 0; i < unit.points; ++i) {
            y[i] = std::abs(offset) * unit.f[i];
        }
        sink_ = made.duration();
        sink_ = cost::smoothness(distance * unit.step, {y.data(), unit.points}, cost::SmoothnessMethod::curvature);
        break;
    case Work::energy_exact:
        static_cast<void>(budget.spend((units::kCandidatePoint + units::kCostPoint) * waypoints));
        detail::make_curve(unit, along, side, distance, offset, speed, limits_, made);
        detail::to_timed_path(made, Vec3::Zero(), timed);
        sink_ = cost::energy(timed, airframe_);
        break;
    case Work::curve_table:
        static_cast<void>(budget.spend(units::kTableLookUp));
        if (const auto found = cost::tables::estimate(cost::tables::kDefault, query)) {
            sink_ = found->time;
            sink_ = found->smoothness;
        }
        break;
    default:
        static_cast<void>(budget.spend(units::kTableEnergy));
        sink_ = cost::tables::energy(cost::tables::kDefault, query).value_or(0.0F);
        break;
    }
    jink_window_end();
}

/// Half-spaces of all levels in any directions, most of them not far from the origin: some contradict each other.
void UnitProbe::program(WorkBudget& budget) noexcept
{
    const std::size_t size = below(planes_.size() + 1);
    const float far = random_.uniform(-2.0F, 4.0F);
    for (std::size_t i = 0; i < size; ++i) {
        orca::HalfSpace& plane = planes_[i];
        plane.normal = (within(1.0F) + Vec3(0.0F, 0.0F, 1e-3F)).normalized();
        plane.offset = -random_.uniform(-1.0F, far);
        plane.level = static_cast<orca::Level>(i * orca::kLevels / size);
    }
    const std::array<orca::Sphere, 2> spheres{{{Vec3::Zero(), 5.0F}, {within(2.0F), random_.uniform(0.1F, 3.0F)}}};
    const Vec3 preferred = within(5.0F);
    jink_window_begin();
    sink_ = orca::solve({{planes_.data(), size}, spheres, preferred, spheres[1].centre}, scratch_.view(), budget)
                .velocity.x();
    jink_window_end();
}

/// A scan of a few to very many hits around.
void UnitProbe::scan() noexcept
{
    static_cast<void>(picture_.configure(app::reach_sets().segments.front().navigation->grid));
    picture_.block_unseen(below(2) == 0);
    reach::ScanStart start;
    start.position = own_.position;
    start.nose = std::atan2(own_.velocity.y(), own_.velocity.x());
    start.unit = random_.uniform(0.5F, 3.0F);
    start.horizontal_pitch = start.vertical_pitch = 0.1F;
    static_cast<void>(picture_.begin(start));
    for (std::size_t i = 0, n = below(4000); i < n; ++i) {
        picture_.add(within(30.0F));
    }
    picture_.end();
}

/// As many candidates as the co-processor's parameters allow, or fewer.
void UnitProbe::candidates() noexcept
{
    geometric::Settings settings;
    constexpr std::array<std::uint16_t, 4> kOffsets{2, 4, 8, 16};
    settings.offsets = kOffsets[below(kOffsets.size())];
    settings.extra_planes = static_cast<std::uint16_t>(below(16));
    settings.simple = below(2) == 0;
    settings.symmetric = below(2) == 0;
    settings.waypoints = static_cast<std::uint16_t>(below(2) == 0 ? 8 : 8 + below(kMaxPathPoints - 7));
    settings.security = below(4) == 0 ? geometric::SecurityMode::swept : geometric::SecurityMode::time_aware;
    settings.moving_nearest = 8;
    if (!geometric_.configure(settings)) {
        static_cast<void>(geometric_.configure({}));
    }
}

/// From anywhere in a pass, one piece, as a step does.
std::uint32_t UnitProbe::tables(WorkBudget& budget) noexcept
{
    reach::TableCheck check(app::reach_sets());
    WorkBudget before(static_cast<std::uint32_t>(below(100'000)));
    static_cast<void>(check.advance(before));
    WorkBudget step = budget.part(check.units_of_next());
    jink_window_begin();
    const Progress progress = check.advance(step);
    jink_window_end();
    sink_ = static_cast<float>(progress);
    return step.spent();
}

std::uint32_t UnitProbe::units_of(Work work, std::uint32_t seed) noexcept
{
    random_ = Random(seed * 977ULL + static_cast<std::uint32_t>(work));
    // In slices, as in a step.
    WorkSlice slice([](void*) noexcept {}, nullptr);
    slice.begin(kAmple);
    WorkBudget budget(kAmple, slice);
    if (work <= Work::margin_solid) {
        geometry(work, budget);
        return budget.spent();
    }
    if (work >= Work::curve_exact && work <= Work::energy_table) {
        limits_ = {};
        curve(work, budget);
        return budget.spent();
    }
    if (work == Work::orca_program) {
        program(budget);
        return budget.spent();
    }
    if (work == Work::table_check) {
        return tables(budget);
    }
    scene(work);
    world::Situation s = situation();
    if (work == Work::objective_route) {
        wind();
        reference_ = world::Reference(route_, 5.0F);
    }
    static_cast<void>(
        threats_.collect(s, {{tracks_.data(), tracks_.size()}, {obstacles_.data(), obstacles_.size()}, airspace_}));
    s.threats = threats_.all();
    const avoid::Settings settings;
    const world::Way way = world::way_of(s);
    const Vec3 command = within(3.0F);
    world::Conflict conflict;
    const float margin = random_.uniform(0.0F, 2.0F);
    orca_.reset();
    reach_.look_at(work == Work::reach_scan ? &picture_ : nullptr);
    if (work == Work::reach_scan) {
        scan();
    }
    if (work >= Work::geometric_tracks) {
        candidates();
        budget = WorkBudget(static_cast<std::uint32_t>(500 + below(20'000)), slice);
    }
    // What is counted is the work alone, without its choice.
    const auto counted = [](const auto& done) noexcept {
        jink_window_begin();
        const auto result = done();
        jink_window_end();
        return result;
    };
    switch (work) {
    case Work::conflict_tracks:
    case Work::conflict_spheres:
    case Work::conflict_solids:
    case Work::conflict_cylinders:
        sink_ = counted([&] { return world::main_conflict(s, way, rules_.lookahead, budget, conflict); }) ? 1.0F : 0.0F;
        break;
    case Work::check:
        sink_ = counted([&] { return avoid::check_manoeuvre(s, manoeuvre_, settings, budget).margin; });
        break;
    case Work::objective_leg:
    case Work::objective_route:
    case Work::objective_solids:
        sink_ = counted([&] {
            return avoid::cost_of(s, manoeuvre_, {manoeuvre_.path.points.data(), manoeuvre_.path.points.size()},
                                  {margin, 1.0F, {world::ThreatKind::track, 0}}, budget)
                .total();
        });
        break;
    case Work::aircraft_look:
        sink_ = counted([&] { return world::aircraft_conflict(s, way, margin < 1.0F, budget, conflict); }) !=
                        world::Alert::none
                    ? 1.0F
                    : 0.0F;
        break;
    case Work::aircraft_command:
        sink_ = counted([&] {
                    return avoid::choose_give_way(s, command, nullptr, settings, budget, manoeuvre_);
                }).value_or(-1.0F);
        break;
    case Work::common_stop:
        sink_ = counted([&] { return avoid::stoppable_command(s, command, command.norm(), budget); }).x();
        break;
    case Work::command: sink_ = counted([&] { return avoid::command_margin(s, command, settings, budget); }); break;
    case Work::orca_tracks:
    case Work::orca_spheres:
    case Work::orca_solids:
        sink_ = counted([&] { return orca_.plan(s, budget, manoeuvre_); }) == world::PlanStatus::found ? 1.0F : 0.0F;
        break;
    case Work::reach_tracks:
    case Work::reach_spheres:
    case Work::reach_solids:
    case Work::reach_cylinders:
    case Work::reach_scan:
        sink_ = counted([&] { return reach_.plan(s, budget, manoeuvre_); }) == world::PlanStatus::found ? 1.0F : 0.0F;
        break;
    case Work::geometric_tracks:
    case Work::geometric_spheres:
    case Work::geometric_solids:
        sink_ =
            counted([&] { return geometric_.plan(s, budget, manoeuvre_); }) == world::PlanStatus::found ? 1.0F : 0.0F;
        break;
    case Work::fallback:
        sink_ = counted([&] { return avoid::choose_fallback(s, way, nullptr, settings, budget).margin; });
        break;
    default: sink_ = counted([&] { return world::least_separation(s, manoeuvre_.path, 40.0F, budget).margin; }); break;
    }
    return budget.spent();
}

}  // namespace

void serve() noexcept
{
    static UnitProbe probe;
    Request request{};
    while (read_all(&request, sizeof request)) {
        Answer answer{};
        if (request.magic == kMagic && request.work < static_cast<std::uint32_t>(Work::count)) {
            answer = {kMagic, request.seed, probe.units_of(static_cast<Work>(request.work), request.seed)};
        }
        write_all(&answer, sizeof answer);
    }
}

}  // namespace jink::target
