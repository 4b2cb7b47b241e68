// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/campaign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <ostream>

#include "core/cost/cost.hpp"
#include "core/geometric/planner.hpp"

namespace jink::host {
namespace {

// Pinheiro tab. 4.1. The moving threat's elevations go by 3.33 from -10: eight of them, which is what makes 16 200
// environments.
constexpr std::array<float, 5> kMainDistances{3.0F, 4.75F, 6.5F, 8.25F, 10.0F};
constexpr int kMainElevations = 9;
constexpr std::array<float, 5> kMainRadii{1.0F, 1.5F, 2.0F, 2.5F, 3.0F};
constexpr std::array<float, 3> kMovingDistances{3.0F, 6.5F, 10.0F};
constexpr int kMovingElevations = 8;
constexpr std::array<float, 3> kMovingRadii{1.0F, 1.5F, 2.0F};
constexpr int kPlanes = 13;  // 0 to 180 degrees by 15, both included
constexpr int kOffsets = 12;
constexpr std::uint16_t kWaypoints = 57;
constexpr float kFan = 3.2F;
/// Offsets that the 2 m cube cannot use are dropped: |w| < R + 1 m (specification, section 8).
constexpr float kBox = 1.0F;
constexpr float kCruise = 5.0F;

struct Environment {
    geometric::Problem problem;
    geometric::Threat moving;
};

struct Sample {
    float time;
    float energy;
};

/// What all environments add to.
struct Study {
    std::vector<Sample> samples;
    std::vector<float> closeness;
    std::ostream* csv = nullptr;
};

Environment make_environment(float distance, float elevation, float radius, const Vec3& moving, float moving_radius)
{
    const Vec3 main(distance, 0.0F, elevation);
    Environment e;
    e.problem.frame = geometric::make_path_frame(Vec3::Zero(), main);
    e.problem.distance = main.norm();
    e.problem.main_radius = radius;
    e.problem.speed = kCruise;
    // The source does not say how the moving threat moves; ours flies at the main threat at cruise speed. Only
    // closeness depends on it.
    const Vec3 towards = main - moving;
    e.moving.motion = {moving, towards.norm() > 0.0F ? Vec3(towards.normalized() * kCruise) : Vec3(Vec3::Zero())};
    e.moving.radius = moving_radius;
    return e;
}

void fly(const Environment& e, const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe, Study& study)
{
    path::TimedPath path;
    for (const geometric::Family family : {geometric::Family::simple, geometric::Family::symmetric}) {
        for (int plane = 0; plane < kPlanes; ++plane) {
            for (int i = 0; i <= kOffsets; ++i) {
                const float offset = kFan * e.problem.main_radius * (2.0F * static_cast<float>(i) / kOffsets - 1.0F);
                if (std::abs(offset) < e.problem.main_radius + kBox) {
                    continue;
                }
                const geometric::CandidateShape shape{family, kPi * static_cast<float>(plane) / (kPlanes - 1), offset};
                if (!geometric::make_candidate_path(e.problem, shape, kWaypoints, limits, path)) {
                    continue;
                }
                const Sample sample{cost::flight_time(path), cost::energy(path, airframe)};
                const cost::MovingThreat threat{e.moving.motion, e.moving.radius, path.duration()};
                study.samples.push_back(sample);
                study.closeness.push_back(cost::closeness(path, threat, cost::ClosenessMethod::swept));
                if (study.csv != nullptr) {
                    *study.csv << e.problem.distance << ',' << e.problem.main_radius << ','
                               << (family == geometric::Family::simple ? "simple" : "symmetric") << ',' << 15 * plane
                               << ',' << offset << ',' << sample.time << ',' << sample.energy << ','
                               << study.closeness.back() << '\n';
                }
            }
        }
    }
}

/// Value below which a share of the sorted values lies, between neighbours by straight line.
double percentile(const std::vector<float>& sorted, double share)
{
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(static_cast<double>(sorted[below]), static_cast<double>(sorted[above]),
                     at - static_cast<double>(below));
}

struct Line {
    double correlation, slope, intercept;
};

/// Least squares of normalised time over normalised energy (Pinheiro 4.3.1, with the caps and the factor of 4.2.2.1,
/// clipped).
Line fit(const std::vector<Sample>& samples)
{
    const cost::Caps caps;
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (const Sample& s : samples) {
        cost::Terms terms;
        terms.time = s.time;
        terms.energy = s.energy;
        const cost::NormalisedTerms n = cost::normalise(terms, caps);
        const double x = static_cast<double>(n.energy);
        const double y = static_cast<double>(n.time);
        sx += x;
        sy += y;
        sxx += x * x;
        syy += y * y;
        sxy += x * y;
    }
    const auto count = static_cast<double>(samples.size());
    const double vx = sxx - sx * sx / count;
    const double vy = syy - sy * sy / count;
    const double c = sxy - sx * sy / count;
    return {c / std::sqrt(vx * vy), c / vx, (sy - c / vx * sx) / count};
}

std::vector<CampaignFigure> figures_of(const Study& study)
{
    std::vector<float> times, energies;
    for (const Sample& s : study.samples) {
        times.push_back(s.time);
        energies.push_back(s.energy);
    }
    std::sort(times.begin(), times.end());
    std::sort(energies.begin(), energies.end());
    constexpr double kShare = 0.995;
    const Line line = fit(study.samples);
    return {
        {"energy, least", "J", 249.59, static_cast<double>(energies.front()), true},
        {"energy, 99.5 %", "J", 1759.0, percentile(energies, kShare), false},
        {"energy, greatest", "J", 2028.5, static_cast<double>(energies.back()), false},
        {"time, least", "s", 1.2530, static_cast<double>(times.front()), false},
        {"time, 99.5 %", "s", 7.0814, percentile(times, kShare), true},
        {"time, greatest", "s", 8.9620, static_cast<double>(times.back()), false},
        {"correlation of time and energy", "", 0.9120, line.correlation, false},
        {"slope of time over energy", "", 1.0013, line.slope, false},
        {"intercept", "", 0.0060, line.intercept, false},
        {"candidates", "", 1062285.0, static_cast<double>(study.samples.size()), false},
    };
}

}  // namespace

CampaignResult run_campaign(const std::function<void(std::size_t, std::size_t)>& progress, std::ostream* csv)
{
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    Study study;
    study.csv = csv;
    if (csv != nullptr) {
        *csv << "distance_m,radius_m,family,plane_deg,offset_m,time_s,energy_j,closeness_1_per_m\n";
    }
    CampaignResult result;
    const std::size_t per_main = kMovingDistances.size() * kMovingElevations * kMovingRadii.size();
    const std::size_t all = kMainDistances.size() * kMainElevations * kMainRadii.size() * per_main;
    for (const float distance : kMainDistances) {
        for (int i = 0; i < kMainElevations; ++i) {
            const float elevation = -7.0F + 1.75F * static_cast<float>(i);
            for (const float radius : kMainRadii) {
                progress(result.environments, all);
                result.environments += per_main;
                if (std::hypot(distance, elevation) < geometric::kLeastDistanceInRadii * radius) {
                    result.environments_skipped += per_main;
                    continue;
                }
                for (const float moving_distance : kMovingDistances) {
                    for (int k = 0; k < kMovingElevations; ++k) {
                        const Vec3 moving(moving_distance, 0.0F, -10.0F + 3.33F * static_cast<float>(k));
                        for (const float moving_radius : kMovingRadii) {
                            fly(make_environment(distance, elevation, radius, moving, moving_radius), limits, airframe,
                                study);
                        }
                    }
                }
            }
        }
    }
    progress(all, all);
    result.candidates = study.samples.size();
    result.figures = figures_of(study);
    const auto middle = study.closeness.begin() + static_cast<std::ptrdiff_t>(study.closeness.size() / 2);
    std::nth_element(study.closeness.begin(), middle, study.closeness.end());
    result.closeness_median = static_cast<double>(*middle);
    return result;
}

}  // namespace jink::host
