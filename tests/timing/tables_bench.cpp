// SPDX-License-Identifier: BSD-3-Clause
// Costs of a candidate by its waypoints, as evaluated by the planner, and by the tables: the same random curves.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/geometric/curve.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"

namespace {

using namespace jink;
using namespace jink::geometric;

struct Drawn {
    Family family;
    Vec3 along, side;
    cost::tables::CurveQuery query;
};

/// Both families the planner has, four planes, any offset; every other leg level, the others within 45 degrees.
const std::vector<Drawn>& curves()
{
    static const std::vector<Drawn> made = [] {
        Random random(1);
        std::vector<Drawn> all;
        for (int i = 0; i < 1000; ++i) {
            const float climb = random.below(2) == 0 ? 0.0F : random.uniform(-1.0F, 1.0F);
            const PathFrame frame = make_path_frame(Vec3::Zero(), Vec3(1.0F, 0.0F, climb));
            Drawn d{random.below(2) == 0 ? Family::simple : Family::symmetric,
                    frame.axes.col(0),
                    detail::plane_direction(frame, 0.25F * kPi * static_cast<float>(random.below(4))),
                    {}};
            const float distance = random.uniform(2.5F, 40.0F);
            d.query = {static_cast<std::size_t>(d.family),
                       random.uniform(-1.28F, 1.28F) * distance,
                       distance,
                       5.0F,
                       d.along.z(),
                       d.side.z()};
            all.push_back(d);
        }
        return all;
    }();
    return made;
}

/// `evaluate(curve)` in turn.
template <class Evaluate>
void run(benchmark::State& state, const Evaluate& evaluate)
{
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(evaluate(curves()[i]));
        i = i + 1 < curves().size() ? i + 1 : 0;
    }
}

class Exact {
public:
    float time_and_smoothness(const Drawn& d)
    {
        make(d);
        const detail::UnitCurve& unit = unit_of(d);
        for (std::size_t i = 0; i < unit.points; ++i) {
            y_[i] = std::abs(d.query.offset) * unit.f[i];
        }
        return curve_.duration() + cost::smoothness(d.query.distance * unit.step, {y_.data(), unit.points},
                                                    cost::SmoothnessMethod::curvature);
    }
    float energy(const Drawn& d)
    {
        make(d);
        detail::to_timed_path(curve_, Vec3::Zero(), path_);
        return cost::energy(path_, airframe_);
    }

private:
    [[nodiscard]] const detail::UnitCurve& unit_of(const Drawn& d) const
    {
        return d.family == Family::simple ? simple_ : symmetric_;
    }
    void make(const Drawn& d)
    {
        detail::make_curve(unit_of(d), d.along, d.side, d.query.distance, d.query.offset, d.query.speed, limits_,
                           curve_);
    }

    vehicle::VehicleLimits limits_;
    vehicle::Airframe airframe_;
    detail::UnitCurve simple_ = detail::make_unit_curve(Family::simple, cost::tables::kDefault.waypoints);
    detail::UnitCurve symmetric_ = detail::make_unit_curve(Family::symmetric, cost::tables::kDefault.waypoints);
    detail::Curve curve_;
    detail::Coordinates y_;
    path::TimedPath path_;
};

void time_and_smoothness_exact(benchmark::State& state)
{
    Exact exact;
    run(state, [&](const Drawn& d) { return exact.time_and_smoothness(d); });
}

void time_and_smoothness_table(benchmark::State& state)
{
    run(state, [](const Drawn& d) {
        const auto found = cost::tables::estimate(cost::tables::kDefault, d.query);
        return found->time + found->smoothness;
    });
}

void energy_exact(benchmark::State& state)
{
    Exact exact;
    run(state, [&](const Drawn& d) { return exact.energy(d); });
}

void energy_table(benchmark::State& state)
{
    run(state, [](const Drawn& d) { return *cost::tables::energy(cost::tables::kDefault, d.query); });
}

BENCHMARK(time_and_smoothness_exact);
BENCHMARK(time_and_smoothness_table);
BENCHMARK(energy_exact);
BENCHMARK(energy_table);

}  // namespace

BENCHMARK_MAIN();
