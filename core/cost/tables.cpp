// SPDX-License-Identifier: BSD-3-Clause
#include "core/cost/tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/static_vector.hpp"

namespace jink::cost::tables {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Upper bound of along_z^2 + side_z^2, with the rounding of a path frame.
constexpr float kUnitTolerance = 1.01F;

/// Position within a row of the table, and interpolation weights.
struct Reader {
    std::size_t first = 0;
    std::array<float, 4> weight{};

    Reader(float ratio, std::size_t steps) noexcept
    {
        const float at = ratio * (static_cast<float>(steps) / kLargestRatio);
        const std::size_t step = std::min(static_cast<std::size_t>(at), steps - 1);
        const float t = at - static_cast<float>(step);
        const float rest = 1.0F - t;
        first = step;  // column 0 lies one step below ratio 0
        weight = {-0.5F * t * rest * rest, 1.0F + t * t * (1.5F * t - 2.5F), t * (0.5F + t * (2.0F - 1.5F * t)),
                  -0.5F * t * t * rest};
    }

    [[nodiscard]] float operator()(std::span<const float> row) const noexcept
    {
        const std::span<const float> v = row.subspan(first, 4);
        return weight[0] * v[0] + weight[1] * v[1] + (weight[2] * v[2] + weight[3] * v[3]);
    }
};

/// A curve of unit distance, and the flight along it.
struct UnitFlight {
    const FamilyTable& family;
    float ratio;    ///< |r|
    float along_z;  ///< rise of a chord per abscissa: along_z + ratio * slope * side_z
    float side_z;   ///< as if r were positive
    float step;     ///< of the abscissa
    Reader arc;

    UnitFlight(const Tables& tables, const CurveQuery& query) noexcept
        : family(tables.families[query.family]), ratio(std::abs(query.offset / query.distance)), along_z(query.along_z),
          side_z(query.offset < 0.0F ? -query.side_z : query.side_z),
          step(family.length / static_cast<float>(family.chords())), arc(ratio, kArcSteps)
    {
    }

    /// Length of the first `count` chords.
    [[nodiscard]] float length_of(std::size_t count) const noexcept
    {
        const std::size_t chords = family.chords();
        if (count == 0) {
            return 0.0F;
        }
        if (!family.mirrored || 2 * count <= chords) {
            return row(count);
        }
        return 2.0F * row(chords / 2) - (count < chords ? row(chords - count) : 0.0F);
    }
    [[nodiscard]] float height_of(std::size_t point) const noexcept
    {
        return along_z * step * static_cast<float>(point) + ratio * side_z * family.offset[point];
    }
    [[nodiscard]] float tangent_of(std::size_t chord) const noexcept { return ratio * family.slope[chord]; }
    [[nodiscard]] float rise_of(std::size_t chord) const noexcept { return along_z + tangent_of(chord) * side_z; }

private:
    [[nodiscard]] float row(std::size_t k) const noexcept
    {
        return arc(family.arc.subspan((k - 1) * kArcColumns, kArcColumns));
    }
};

/// Open interval of tangents p of a curve in its plane.
struct Tangents {
    float low = kInfinity;
    float high = -kInfinity;
};

/// Tangents p for which per_rate (along_z + p side_z) > sqrt(1 + p^2), so that a vertical rate of speed / per_rate is
/// exceeded: a line above a branch of a hyperbola. Empty, an interval or a half-line.
Tangents binding_tangents(float per_rate, float along_z, float side_z) noexcept
{
    const float a = per_rate * along_z;
    const float s = per_rate * std::abs(side_z);
    const float discriminant = a * a + s * s - 1.0F;
    const float squared = s * s - 1.0F;  // of squared p^2 + 2 linear p + constant > 0
    if (!(discriminant > 0.0F) || !(squared > 0.0F || a > 0.0F)) {
        return {};
    }
    const float linear = a * s;
    const float root = std::sqrt(discriminant);
    // Each root in the form without a difference of similar numbers.
    const float low = linear >= 0.0F ? (1.0F - a * a) / (root + linear) : (root - linear) / squared;
    const float high = squared < 0.0F ? (root + linear) / -squared : kInfinity;
    return side_z < 0.0F ? Tangents{-high, -low} : Tangents{low, high};
}

/// Chords [begin, end) on which a limit binds; each takes its rise / rate, a rate of descent being negative.
struct BoundChords {
    std::size_t begin = 0;
    std::size_t end = 0;
    float rate = 0.0F;
};
using AllBound = StaticVector<BoundChords, 2 * kMaxRuns>;

/// Number of chords of a run, from `begin` on, for which `holds`. These chords come before all others of the run.
template <class Predicate>
std::size_t partition(std::size_t begin, std::size_t end, const Predicate& holds) noexcept
{
    while (begin < end) {
        const std::size_t middle = begin + (end - begin) / 2;
        if (holds(middle)) {
            begin = middle + 1;
        } else {
            end = middle;
        }
    }
    return begin;
}

void find_bound(const UnitFlight& flight, const Tangents& tangents, float rate, AllBound& out) noexcept
{
    if (!(tangents.low < tangents.high)) {
        return;
    }
    const std::size_t before = out.size();
    std::size_t begin = 0;
    for (const std::size_t end : flight.family.runs) {
        const float first_tangent = flight.tangent_of(begin);
        const float last_tangent = flight.tangent_of(end - 1);
        const bool grows = first_tangent < last_tangent;
        if (!(std::max(first_tangent, last_tangent) > tangents.low &&
              std::min(first_tangent, last_tangent) < tangents.high)) {
            begin = end;
            continue;
        }
        // Most runs are bound from one of their ends on: the search starts from the end that is known.
        const auto past_near = [&](std::size_t i) {
            return grows ? flight.tangent_of(i) <= tangents.low : flight.tangent_of(i) >= tangents.high;
        };
        const auto before_far = [&](std::size_t i) {
            return grows ? flight.tangent_of(i) < tangents.high : flight.tangent_of(i) > tangents.low;
        };
        const std::size_t first = past_near(begin) ? partition(begin + 1, end, past_near) : begin;
        const std::size_t last = before_far(end - 1) ? end : partition(first, end - 1, before_far);
        if (last > first) {
            if (out.size() > before && out.back().end == first) {
                out.back().end = last;
            } else {
                out.unchecked_push_back({first, last, rate});  // at most one per run and limit
            }
        }
        begin = end;
    }
}

void find_all_bound(const Tables& tables, const UnitFlight& flight, float speed, AllBound& out) noexcept
{
    find_bound(flight, binding_tangents(speed / tables.max_climb, flight.along_z, flight.side_z), tables.max_climb,
               out);
    find_bound(flight, binding_tangents(speed / tables.max_descent, -flight.along_z, -flight.side_z),
               -tables.max_descent, out);
}

/// In-place insertion sort; there are a handful.
void sort_by_begin(AllBound& all) noexcept
{
    for (std::size_t i = 1; i < all.size(); ++i) {
        for (std::size_t k = i; k > 0 && all[k].begin < all[k - 1].begin; --k) {
            std::swap(all[k], all[k - 1]);
        }
    }
}

/// Time for D = 1.
float unit_time(const UnitFlight& flight, float length, float speed, const AllBound& all) noexcept
{
    float free = length;
    float bound = 0.0F;
    for (const BoundChords& chords : all) {
        free -= flight.length_of(chords.end) - flight.length_of(chords.begin);
        bound += (flight.height_of(chords.end) - flight.height_of(chords.begin)) / chords.rate;
    }
    return free / speed + bound;
}

/// Sum of |rise| for D = 1.
float total_rise(const UnitFlight& flight) noexcept
{
    float sum = 0.0F;
    std::size_t begin = 0;
    for (const std::size_t end : flight.family.runs) {
        const bool rises = flight.rise_of(begin) > 0.0F;
        const std::size_t turn =
            partition(begin, end, [&](std::size_t i) { return (flight.rise_of(i) > 0.0F) == rises; });
        const float top = flight.height_of(turn);
        sum += std::abs(top - flight.height_of(begin)) + std::abs(flight.height_of(end) - top);
        begin = end;
    }
    return sum;
}

/// Sums over some chords, for D = 1: values without any limit, and values as flown, over mass and drag.
struct Shares {
    float length = 0.0F, turn = 0.0F, rise = 0.0F;
    float mechanical = 0.0F;  ///< [m2/s2]
    float dragged = 0.0F;     ///< [m2/s2] per D
};

/// One chord as flown.
struct Chord {
    float length = 0.0F, tangent = 0.0F, rise = 0.0F;  ///< per step of the abscissa
    float speed = 0.0F;

    Chord(const Tables& tables, const UnitFlight& flight, float cruise, std::size_t i) noexcept
        : tangent(flight.tangent_of(i)), rise(flight.rise_of(i))
    {
        length = std::sqrt(1.0F + tangent * tangent);
        const float slowest = std::max(length / cruise, std::max(rise / tables.max_climb, -rise / tables.max_descent));
        speed = length / slowest;
    }
};

/// Adds the chords [begin, end), with their velocities and that of the chord after them computed exactly.
void add_exactly(const Tables& tables, const UnitFlight& flight, const CurveQuery& query, std::size_t begin,
                 std::size_t end, Shares& sum) noexcept
{
    Chord here(tables, flight, query.speed, begin);
    for (std::size_t i = begin; i < end; ++i) {
        // The last waypoint repeats the velocity of the last chord.
        const Chord next = i + 1 < flight.family.chords() ? Chord(tables, flight, query.speed, i + 1) : here;
        const float cosine = (1.0F + here.tangent * next.tangent) / (here.length * next.length);
        const float length = flight.step * here.length;
        sum.length += length;
        sum.turn += 2.0F * length * (1.0F - cosine);
        sum.rise += flight.step * std::abs(here.rise);
        const float kinetic = 0.5F * (next.speed - here.speed) * (next.speed + here.speed);
        sum.mechanical += std::abs(kinetic + kGravity * query.distance * flight.step * here.rise);
        sum.dragged +=
            length * (here.speed * here.speed + next.speed * next.speed + 2.0F * here.speed * next.speed * cosine);
        here = next;
    }
}

bool has_shape(const Tables& tables, std::size_t family, float offset, float distance) noexcept
{
    return family < tables.families.size() && distance > 0.0F && distance < kInfinity &&
           std::abs(offset) <= kLargestRatio * distance;
}

float smoothness_of(const FamilyTable& family, float ratio, float distance) noexcept
{
    return ratio * ratio * Reader(ratio, kBendSteps)(family.bend) / distance;
}

}  // namespace

Tables with_limits(const Tables& tables, const vehicle::VehicleLimits& limits,
                   const vehicle::Airframe& airframe) noexcept
{
    Tables out = tables;
    out.cruise_speed = limits.cruise_speed;
    out.max_climb = limits.max_climb;
    out.max_descent = limits.max_descent;
    out.mass = airframe.mass;
    out.drag = 0.25F * airframe.drag_coefficient * airframe.air_density * airframe.effective_area;
    out.caps = caps_for(limits, airframe);
    return out;
}

bool covers(const Tables& tables, const CurveQuery& query) noexcept
{
    const float steepness = query.along_z * query.along_z + query.side_z * query.side_z;
    return has_shape(tables, query.family, query.offset, query.distance) && query.speed > 0.0F &&
           query.speed < kInfinity && steepness <= kUnitTolerance;
}

std::optional<float> smoothness(const Tables& tables, std::size_t family, float offset, float distance) noexcept
{
    if (!has_shape(tables, family, offset, distance)) {
        return std::nullopt;
    }
    return smoothness_of(tables.families[family], std::abs(offset / distance), distance);
}

std::optional<Estimate> estimate(const Tables& tables, const CurveQuery& query) noexcept
{
    if (!covers(tables, query)) {
        return std::nullopt;
    }
    const UnitFlight flight(tables, query);
    const float length = flight.length_of(flight.family.chords());
    AllBound bound;
    find_all_bound(tables, flight, query.speed, bound);
    return Estimate{.length = query.distance * length,
                    .time = query.distance * unit_time(flight, length, query.speed, bound),
                    .smoothness = smoothness_of(flight.family, flight.ratio, query.distance)};
}

std::optional<float> energy(const Tables& tables, const CurveQuery& query) noexcept
{
    if (!covers(tables, query)) {
        return std::nullopt;
    }
    const UnitFlight flight(tables, query);
    AllBound bound;
    find_all_bound(tables, flight, query.speed, bound);
    sort_by_begin(bound);
    Shares exact;
    std::size_t done = 0;
    for (const BoundChords& chords : bound) {
        // The chord before the bound chords ends at their speed.
        add_exactly(tables, flight, query, std::max(done, std::max<std::size_t>(chords.begin, 1) - 1), chords.end,
                    exact);
        done = chords.end;
    }
    const float length = flight.length_of(flight.family.chords()) - exact.length;
    const float turn = flight.ratio * flight.ratio * flight.arc(flight.family.turn) - exact.turn;
    const float rise = total_rise(flight) - exact.rise;
    const float mechanical = exact.mechanical + kGravity * query.distance * rise;
    const float dragged = exact.dragged + query.speed * query.speed * (4.0F * length - turn);
    return tables.mass * mechanical + tables.drag * query.distance * dragged;
}

}  // namespace jink::cost::tables
