// SPDX-License-Identifier: BSD-3-Clause
// Comparison of look-ups with the exact evaluation.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "toolchain/host/cost_tables.hpp"

namespace jink::host {
namespace {

using cost::tables::CurveQuery;
using cost::tables::FamilyTable;
using cost::tables::kArcColumns;
using cost::tables::kArcSteps;
using cost::tables::Tables;

double wide(float value) { return static_cast<double>(value); }

/// Independent Catmull-Rom spline in double precision.
double interpolated(std::span<const float> row, double ratio)
{
    const double at = ratio / wide(cost::tables::kLargestRatio) * static_cast<double>(kArcSteps);
    const std::size_t i = std::min(static_cast<std::size_t>(at), kArcSteps - 1);
    const double t = at - static_cast<double>(i);
    const double a = wide(row[i]);
    const double b = wide(row[i + 1]);
    const double c = wide(row[i + 2]);
    const double d = wide(row[i + 3]);
    return 0.5 * (2.0 * b + t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))));
}

/// Sum of the errors of the tabulated chord lengths, over the total length.
double error_of_chords(const FamilyTable& table, const ExactCurve& curve, double ratio)
{
    const std::size_t rows = table.arc.size() / kArcColumns;
    double sum = 0.0;
    double before = 0.0;
    for (std::size_t k = 0; k < rows; ++k) {
        const double until = interpolated(table.arc.subspan(k * kArcColumns, kArcColumns), ratio);
        sum += std::abs(until - before - curve.chord(k, ratio));
        before = until;
    }
    return (table.mirrored ? 2.0 : 1.0) * sum / curve.length(ratio);
}

double relative(double found, double exact) { return exact == found ? 0.0 : std::abs(found / exact - 1.0); }

/// The sampling of one family.
class Sampling {
public:
    Sampling(const Tables& tables, std::size_t family, const Density& density)
        : tables_(tables), family_(family), density_(density), curve_(curve_families()[family], tables.waypoints)
    {
        vehicle_.max_climb = wide(tables.max_climb);
        vehicle_.max_descent = wide(tables.max_descent);
        vehicle_.mass = wide(tables.mass);
        vehicle_.drag = wide(tables.drag);
    }

    TableErrors operator()()
    {
        const std::size_t count = density_.per_step * cost::tables::kBendSteps;
        for (std::size_t i = 0; i <= count; ++i) {
            const double ratio =
                wide(cost::tables::kLargestRatio) * static_cast<double>(i) / static_cast<double>(count);
            const double used = wide(static_cast<float>(ratio));
            look_at_ratio(used);
            for (std::size_t e = 0; e < density_.elevations; ++e) {
                look_at_leg(used, angle(e, density_.elevations), i % density_.energy_every == 0);
            }
        }
        return errors_;
    }

private:
    static double angle(std::size_t i, std::size_t count)
    {
        return std::numbers::pi * (static_cast<double>(i) / static_cast<double>(count - 1) - 0.5);
    }

    void look_at_ratio(double ratio)
    {
        const CurveQuery query = query_of(ratio, 1.0, wide(tables_.cruise_speed), 0.0, 0.0);
        const auto found = cost::tables::estimate(tables_, query);
        ++errors_.look_ups;
        if (!found) {
            ++errors_.refused;
            return;
        }
        take(errors_.length, wide(found->length), curve_.length(ratio));
        take(errors_.smoothness, wide(found->smoothness), curve_.bend(ratio));
        errors_.chords = std::max(errors_.chords, error_of_chords(tables_.families[family_], curve_, ratio));
    }

    void look_at_leg(double ratio, double elevation, bool with_energy)
    {
        const double along = std::sin(elevation);
        for (std::size_t p = 0; p < density_.planes; ++p) {
            const double side = std::cos(elevation) * std::sin(angle(p, density_.planes));
            for (const double share : kSpeedShares) {
                const double speed = share * wide(tables_.cruise_speed);
                look_up(query_of(ratio, 1.0, speed, along, side), false);
                for (const double distance : kEnergyDistances) {
                    if (with_energy) {
                        look_up(query_of(ratio, distance, speed, along, side), true);
                    }
                }
            }
        }
    }

    [[nodiscard]] CurveQuery query_of(double ratio, double distance, double speed, double along, double side) const
    {
        CurveQuery query;
        query.family = family_;
        query.offset = static_cast<float>(ratio * distance);
        query.distance = static_cast<float>(distance);
        query.speed = static_cast<float>(speed);
        query.along_z = static_cast<float>(along);
        query.side_z = static_cast<float>(side);
        return query;
    }

    void look_up(const CurveQuery& query, bool energy)
    {
        ExactQuery exact = vehicle_;
        exact.offset = wide(query.offset);
        exact.distance = wide(query.distance);
        exact.speed = wide(query.speed);
        exact.along_z = wide(query.along_z);
        exact.side_z = wide(query.side_z);
        ++errors_.look_ups;
        if (energy) {
            const auto found = cost::tables::energy(tables_, query);
            found ? take(errors_.energy, wide(*found), curve_.energy(exact)) : void(++errors_.refused);
        } else {
            const auto found = cost::tables::estimate(tables_, query);
            found ? take(errors_.time, wide(found->time), curve_.time(exact)) : void(++errors_.refused);
        }
    }

    static void take(double& worst, double found, double exact) { worst = std::max(worst, relative(found, exact)); }

    const Tables& tables_;
    std::size_t family_;
    Density density_;
    ExactCurve curve_;
    ExactQuery vehicle_;
    TableErrors errors_;
};

}  // namespace

TableErrors sample_errors(const Tables& tables, std::size_t family, const Density& density)
{
    return Sampling(tables, family, density)();
}

bool holds(const TableErrors& errors, const cost::tables::Bounds& bounds)
{
    return errors.refused == 0 && errors.length <= wide(bounds.length) &&
           std::max(errors.time, errors.chords) <= wide(bounds.time) && errors.smoothness <= wide(bounds.smoothness) &&
           errors.energy <= wide(bounds.energy);
}

}  // namespace jink::host
