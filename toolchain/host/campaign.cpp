// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/campaign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/cost/cost.hpp"
#include "core/geometric/planner.hpp"
#include "toolchain/sim/statistics.hpp"

namespace jink::host {
namespace {

// Pinheiro tab. 4.1. The moving threat's elevations go in steps of 3.33 degrees from -10: eight elevations, which give
// 16 200 environments.
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
    geometry::Motion moving;
    float moving_radius = 0.0F;
};

Environment make_environment(float distance, float elevation, float radius, const Vec3& moving, float moving_radius)
{
    const Vec3 main(distance, 0.0F, elevation);
    Environment e;
    e.problem.frame = geometric::make_path_frame(Vec3::Zero(), main);
    e.problem.distance = main.norm();
    e.problem.main_radius = radius;
    e.problem.speed = kCruise;
    // Pinheiro does not give the moving threat's motion; here it flies at the main threat at cruise speed. Only
    // closeness depends on this motion.
    const Vec3 towards = main - moving;
    e.moving = {moving, towards.norm() > 0.0F ? Vec3(towards.normalized() * kCruise) : Vec3(Vec3::Zero())};
    e.moving_radius = moving_radius;
    return e;
}

void fly(const Environment& e, const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe,
         StudyBlock& block, std::ostream* rows)
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
                block.times.push_back(cost::flight_time(path));
                block.energies.push_back(cost::energy(path, airframe));
                block.closeness.push_back(
                    cost::closeness(path, e.moving, e.moving_radius, cost::ClosenessMethod::swept, path.duration()));
                if (rows != nullptr) {
                    *rows << e.problem.distance << ',' << e.problem.main_radius << ','
                          << (family == geometric::Family::simple ? "simple" : "symmetric") << ',' << 15 * plane << ','
                          << offset << ',' << block.times.back() << ',' << block.energies.back() << ','
                          << block.closeness.back() << '\n';
                }
            }
        }
    }
}

struct Line {
    double correlation, slope, intercept;
};

/// Least squares of normalised time over normalised energy (Pinheiro 4.3.1, with the caps and the factor of 4.2.2.1,
/// clipped).
Line fit(const std::vector<float>& times, const std::vector<float>& energies)
{
    const cost::Caps caps;
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        cost::Terms terms;
        terms.time = times[i];
        terms.energy = energies[i];
        const cost::NormalisedTerms n = cost::normalise(terms, caps);
        const double x = static_cast<double>(n.energy);
        const double y = static_cast<double>(n.time);
        sx += x;
        sy += y;
        sxx += x * x;
        syy += y * y;
        sxy += x * y;
    }
    const auto count = static_cast<double>(times.size());
    const double vx = sxx - sx * sx / count;
    const double vy = syy - sy * sy / count;
    const double c = sxy - sx * sy / count;
    return {c / std::sqrt(vx * vy), c / vx, (sy - c / vx * sx) / count};
}

std::vector<CampaignFigure> figures_of(std::vector<float> times, std::vector<float> energies)
{
    const Line line = fit(times, energies);
    std::sort(times.begin(), times.end());
    std::sort(energies.begin(), energies.end());
    constexpr double kShare = 0.995;
    return {
        {"energy, least", "J", 249.59, static_cast<double>(energies.front()), true},
        {"energy, 99.5 %", "J", 1759.0, sim::quantile(energies, kShare), false},
        {"energy, greatest", "J", 2028.5, static_cast<double>(energies.back()), false},
        {"time, least", "s", 1.2530, static_cast<double>(times.front()), false},
        {"time, 99.5 %", "s", 7.0814, sim::quantile(times, kShare), true},
        {"time, greatest", "s", 8.9620, static_cast<double>(times.back()), false},
        {"correlation of time and energy", "", 0.9120, line.correlation, false},
        {"slope of time over energy", "", 1.0013, line.slope, false},
        {"intercept", "", 0.0060, line.intercept, false},
        {"candidates", "", 1062285.0, static_cast<double>(times.size()), false},
    };
}

/// The main threat of a block: distance, elevation and radius in the order of variation, the last fastest.
struct Main {
    float distance, elevation, radius;
};

Main main_threat_of(std::size_t index)
{
    const std::size_t radius = index % kMainRadii.size();
    const std::size_t elevation = index / kMainRadii.size() % kMainElevations;
    const std::size_t distance = index / kMainRadii.size() / kMainElevations;
    return {kMainDistances[distance], -7.0F + 1.75F * static_cast<float>(elevation), kMainRadii[radius]};
}

template <class Value>
void append_bytes(std::string& bytes, const Value* values, std::size_t count)
{
    static_assert(std::is_trivially_copyable_v<Value>);
    if (count > 0) {
        bytes.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
    }
}

/// Removes values from the front of `bytes`.
template <class Value>
void take_bytes(std::string_view& bytes, Value* values, std::size_t count)
{
    if (bytes.size() / sizeof(Value) < count) {
        throw std::runtime_error("a packed block of the study ends early");
    }
    if (count > 0) {
        std::memcpy(values, bytes.data(), count * sizeof(Value));
    }
    bytes.remove_prefix(count * sizeof(Value));
}

/// Header of a packed block.
struct Head {
    std::uint64_t index, skipped, candidates, row_bytes;
};

}  // namespace

static_assert(kStudyBlocks == kMainDistances.size() * kMainElevations * kMainRadii.size());

StudyBlock fly_study_block(std::size_t index, bool with_rows)
{
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const Main threat = main_threat_of(index);
    StudyBlock block;
    if (std::hypot(threat.distance, threat.elevation) < geometric::kMinDistanceInRadii * threat.radius) {
        block.environments_skipped = kStudyEnvironments;
        return block;
    }
    std::ostringstream rows;
    for (const float moving_distance : kMovingDistances) {
        for (int k = 0; k < kMovingElevations; ++k) {
            const Vec3 moving(moving_distance, 0.0F, -10.0F + 3.33F * static_cast<float>(k));
            for (const float moving_radius : kMovingRadii) {
                fly(make_environment(threat.distance, threat.elevation, threat.radius, moving, moving_radius), limits,
                    airframe, block, with_rows ? &rows : nullptr);
            }
        }
    }
    block.rows = rows.str();
    return block;
}

std::string packed(std::size_t index, const StudyBlock& block)
{
    const Head head{index, block.environments_skipped, block.times.size(), block.rows.size()};
    std::string bytes;
    append_bytes(bytes, &head, 1);
    append_bytes(bytes, block.times.data(), block.times.size());
    append_bytes(bytes, block.energies.data(), block.energies.size());
    append_bytes(bytes, block.closeness.data(), block.closeness.size());
    return bytes.append(block.rows);
}

void unpack(std::string_view bytes, std::vector<StudyBlock>& blocks)
{
    Head head{};
    take_bytes(bytes, &head, 1);
    StudyBlock& block = blocks.at(head.index);
    block.environments_skipped = head.skipped;
    for (std::vector<float>* values : {&block.times, &block.energies, &block.closeness}) {
        values->resize(std::min<std::size_t>(head.candidates, bytes.size() / sizeof(float)));
        take_bytes(bytes, values->data(), head.candidates);
    }
    block.rows.resize(std::min<std::size_t>(head.row_bytes, bytes.size()));
    take_bytes(bytes, block.rows.data(), head.row_bytes);
}

CampaignResult merge_study(const std::vector<StudyBlock>& blocks)
{
    CampaignResult result;
    std::vector<float> times, energies, closeness;
    for (const StudyBlock& block : blocks) {
        result.environments += kStudyEnvironments;
        result.environments_skipped += block.environments_skipped;
        times.insert(times.end(), block.times.begin(), block.times.end());
        energies.insert(energies.end(), block.energies.begin(), block.energies.end());
        closeness.insert(closeness.end(), block.closeness.begin(), block.closeness.end());
    }
    result.candidates = times.size();
    result.figures = figures_of(std::move(times), std::move(energies));
    const auto middle = closeness.begin() + static_cast<std::ptrdiff_t>(closeness.size() / 2);
    std::nth_element(closeness.begin(), middle, closeness.end());
    result.closeness_median = static_cast<double>(*middle);
    return result;
}

void write_rows(std::ostream& csv, const std::vector<StudyBlock>& blocks)
{
    csv << "distance_m,radius_m,family,plane_deg,offset_m,time_s,energy_j,closeness_1_per_m\n";
    for (const StudyBlock& block : blocks) {
        csv << block.rows;
    }
}

std::vector<StudyBlock> fly_study(const std::function<void(std::size_t, std::size_t)>& progress, bool with_rows)
{
    std::vector<StudyBlock> blocks;
    for (std::size_t i = 0; i < kStudyBlocks; ++i) {
        progress(i * kStudyEnvironments, kStudyBlocks * kStudyEnvironments);
        blocks.push_back(fly_study_block(i, with_rows));
    }
    progress(kStudyBlocks * kStudyEnvironments, kStudyBlocks * kStudyEnvironments);
    return blocks;
}

CampaignResult run_campaign(const std::function<void(std::size_t, std::size_t)>& progress)
{
    return merge_study(fly_study(progress, false));
}

}  // namespace jink::host
