// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/cost/cost.hpp"

namespace jink::cost {
namespace {

/// Derivative of `values` over their index: central differences, one-sided at the ends.
template <class Values>
float gradient(const Values& values, std::size_t i, std::size_t n) noexcept
{
    if (i == 0) {
        return values(1) - values(0);
    }
    if (i + 1 == n) {
        return values(i) - values(i - 1);
    }
    return 0.5F * (values(i + 1) - values(i - 1));
}

/// First and second derivatives of one coordinate over the index.
struct Derivatives {
    float first = 0.0F;
    float second = 0.0F;
};

Derivatives derive(std::span<const float> values, std::size_t i) noexcept
{
    const std::size_t n = values.size();
    const auto value = [&](std::size_t k) { return values[k]; };
    const auto slope = [&](std::size_t k) { return gradient(value, k, n); };
    return {slope(i), gradient(slope, i, n)};
}

float integral_of_squared_curvature(std::span<const float> x, std::span<const float> y) noexcept
{
    float integral = 0.0F;
    float before = 0.0F;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Derivatives dx = derive(x, i);
        const Derivatives dy = derive(y, i);
        const float bend = dx.second * dy.first - dx.first * dy.second;
        const float stretch = dx.first * dx.first + dy.first * dy.first;
        const float squared = bend * bend / (stretch * stretch * stretch);
        if (i > 0) {
            integral += 0.5F * (squared + before) * (x[i] - x[i - 1]);
        }
        before = squared;
    }
    return integral;
}

/// Calls `visit` with the first and second derivatives of each point in turn; each slope is computed once.
template <class Visit>
void derive_all(std::span<const float> values, const Visit& visit) noexcept
{
    const std::size_t last = values.size() - 1;
    float before = values[1] - values[0];
    float here = 0.5F * (values[2] - values[0]);
    visit(before, here - before);
    for (std::size_t i = 1; i < last; ++i) {
        const float after = i + 1 < last ? 0.5F * (values[i + 2] - values[i]) : values[last] - values[last - 1];
        visit(here, 0.5F * (after - before));
        before = here;
        here = after;
    }
    visit(here, here - before);
}

/// At equal steps the abscissa's first derivative is the step and its second derivative is zero.
float integral_of_squared_curvature(float step, std::span<const float> y) noexcept
{
    const float squared_step = step * step;
    float sum = 0.0F;
    float first = -1.0F;
    float last = 0.0F;
    derive_all(y, [&](float slope, float bend) {
        const float stretch = squared_step + slope * slope;
        last = bend * bend / (stretch * stretch * stretch);
        first = first < 0.0F ? last : first;
        sum += last;
    });
    return step * squared_step * (sum - 0.5F * (first + last));
}

float mean_second_derivative(float step, std::span<const float> y) noexcept
{
    float sum = 0.0F;
    derive_all(y, [&](float, float bend) { sum += std::abs(bend); });
    return sum / (step * step * static_cast<float>(y.size()));
}

float standard_deviation(std::span<const float> y) noexcept
{
    const auto n = static_cast<float>(y.size());
    float sum = 0.0F;
    for (const float value : y) {
        sum += value;
    }
    const float mean = sum / n;
    float squares = 0.0F;
    for (const float value : y) {
        squares += (value - mean) * (value - mean);
    }
    return std::sqrt(squares / n);
}

float mean_second_derivative(std::span<const float> x, std::span<const float> y) noexcept
{
    float sum = 0.0F;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Derivatives dx = derive(x, i);
        const Derivatives dy = derive(y, i);
        sum += std::abs(dx.first * dy.second - dx.second * dy.first) / (dx.first * dx.first * dx.first);
    }
    return sum / static_cast<float>(x.size());
}

/// Accumulates the terms of `closeness` over points.
class Closeness {
public:
    Closeness(const geometry::Motion& threat, float radius, ClosenessMethod method, Seconds swept_for) noexcept
        : threat_(threat), radius_(radius), method_(method), swept_for_(swept_for)
    {
        // Along the threat's path the nearest point lies at the time t where (p - position - velocity t) is
        // perpendicular to the velocity.
        const float speed_squared = threat.velocity.squaredNorm();
        per_speed_ = speed_squared > 0.0F ? 1.0F / speed_squared : 0.0F;
    }

    [[nodiscard]] float distance_squared(float x, float y, float z, Seconds time) const noexcept
    {
        const Vec3& position = threat_.position;
        const Vec3& velocity = threat_.velocity;
        const float from_x = x - position.x();
        const float from_y = y - position.y();
        const float from_z = z - position.z();
        const float along = (from_x * velocity.x() + (from_y * velocity.y() + from_z * velocity.z())) * per_speed_;
        const Seconds t = method_ == ClosenessMethod::time_aware ? time : std::min(std::max(along, 0.0F), swept_for_);
        const float apart_x = from_x - t * velocity.x();
        const float apart_y = from_y - t * velocity.y();
        const float apart_z = from_z - t * velocity.z();
        return apart_x * apart_x + (apart_y * apart_y + apart_z * apart_z);
    }
    void add(float distance_squared, float distance) noexcept
    {
        sum_ += distance;
        least_squared_ = std::min(least_squared_, distance_squared);
    }
    [[nodiscard]] float of(std::size_t count) const noexcept
    {
        const float mean = sum_ / static_cast<float>(count);
        const float bracket = 0.5F * mean + 0.5F * std::sqrt(least_squared_) - radius_;
        return bracket > 0.0F ? 1.0F / bracket : std::numeric_limits<float>::infinity();
    }

private:
    const geometry::Motion& threat_;
    float radius_;
    ClosenessMethod method_;
    Seconds swept_for_;
    float per_speed_;
    float least_squared_ = std::numeric_limits<float>::infinity();
    float sum_ = 0.0F;
};

}  // namespace

float flight_time(const path::TimedPath& path) noexcept { return path.duration(); }

float smoothness(std::span<const float> x, std::span<const float> y, SmoothnessMethod method) noexcept
{
    switch (method) {
    case SmoothnessMethod::curvature: return integral_of_squared_curvature(x, y);
    case SmoothnessMethod::deviation: return standard_deviation(y);
    case SmoothnessMethod::second_derivative: return mean_second_derivative(x, y);
    }
    return 0.0F;
}

float smoothness(float step, std::span<const float> y, SmoothnessMethod method) noexcept
{
    switch (method) {
    case SmoothnessMethod::curvature: return integral_of_squared_curvature(step, y);
    case SmoothnessMethod::deviation: return standard_deviation(y);
    case SmoothnessMethod::second_derivative: return mean_second_derivative(step, y);
    }
    return 0.0F;
}

float penalised_smoothness(float smoothness, float sin_alpha, float penalty) noexcept
{
    return smoothness * (1.0F + penalty * std::abs(sin_alpha));
}

float closeness(const path::TimedPath& path, const geometry::Motion& threat, float radius, ClosenessMethod method,
                Seconds swept_for) noexcept
{
    Closeness closeness(threat, radius, method, swept_for);
    for (const auto& point : path.points) {
        const Vec3& p = point.position;
        const float squared = closeness.distance_squared(p.x(), p.y(), p.z(), point.time);
        closeness.add(squared, std::sqrt(squared));
    }
    return closeness.of(path.points.size());
}

float closeness(const Waypoints& path, const geometry::Motion& threat, float radius, ClosenessMethod method,
                Seconds swept_for) noexcept
{
    // Roots are computed in groups, for targets with vector registers; the sum keeps its order.
    constexpr std::size_t kAtOnce = 8;
    Closeness closeness(threat, radius, method, swept_for);
    const std::size_t count = path.t.size();
    std::size_t i = 0;
    for (; i + kAtOnce <= count; i += kAtOnce) {
        std::array<float, kAtOnce> squared{};
        std::array<float, kAtOnce> distance{};
        for (std::size_t k = 0; k < kAtOnce; ++k) {
            squared[k] = closeness.distance_squared(path.x[i + k], path.y[i + k], path.z[i + k], path.t[i + k]);
            distance[k] = std::sqrt(squared[k]);
        }
        for (std::size_t k = 0; k < kAtOnce; ++k) {
            closeness.add(squared[k], distance[k]);
        }
    }
    for (; i < count; ++i) {
        const float squared = closeness.distance_squared(path.x[i], path.y[i], path.z[i], path.t[i]);
        closeness.add(squared, std::sqrt(squared));
    }
    return closeness.of(count);
}

float combined_closeness(std::span<const float> per_threat) noexcept
{
    if (per_threat.empty()) {
        return 0.0F;
    }
    float sum = 0.0F;
    float greatest = 0.0F;
    for (const float f : per_threat) {
        sum += f;
        greatest = std::max(greatest, f);
    }
    return 0.5F * greatest + 0.5F * sum / static_cast<float>(per_threat.size());
}

Passing passing(const Waypoints& path, const geometry::Motion& threat, float radius) noexcept
{
    const Vec3 velocity = threat.velocity;
    const auto apart_at = [&](std::size_t i) {
        return Vec3(Vec3(path.x[i], path.y[i], path.z[i]) - threat.position - path.t[i] * velocity);
    };
    std::size_t nearest = 0;
    float least_squared = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < path.t.size(); ++i) {
        const float squared = apart_at(i).squaredNorm();
        if (squared < least_squared) {
            least_squared = squared;
            nearest = i;
        }
    }
    const float distance = std::sqrt(least_squared);
    const float lengths = distance * velocity.norm();
    const float cosine = lengths > 0.0F ? apart_at(nearest).dot(velocity) / lengths : 0.0F;
    return {0.5F + 0.5F * std::clamp(cosine, -1.0F, 1.0F), distance - radius};
}

float time_beyond(const Waypoints& path, const Vec3& along, float distance) noexcept
{
    const auto abscissa = [&](std::size_t i) { return Vec3(path.x[i], path.y[i], path.z[i]).dot(along); };
    for (std::size_t i = 0; i < path.t.size(); ++i) {
        const float here = abscissa(i);
        if (here < distance) {
            continue;
        }
        const float before = i > 0 ? abscissa(i - 1) : here;
        const float share = here > before ? (here - distance) / (here - before) : 0.0F;
        const Seconds step = i > 0 ? path.t[i] - path.t[i - 1] : 0.0F;
        return path.t.back() - (path.t[i] - share * step);
    }
    return 0.0F;
}

float energy(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept
{
    const float drag = 0.25F * airframe.drag_coefficient * airframe.air_density * airframe.effective_area;
    float mechanical = 0.0F;
    float dragged = 0.0F;
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
        const path::PathPoint& from = path.points[i];
        const path::PathPoint& to = path.points[i + 1];
        const Vec3 step = to.position - from.position;
        const Vec3 sum = to.velocity + from.velocity;
        // (v1^2 - v0^2) / 2 as a product of sum and difference: avoids the cancellation of large heights or squares.
        const float kinetic = 0.5F * sum.dot(to.velocity - from.velocity);
        mechanical += airframe.mass * std::abs(kinetic + kGravity * step.z());
        dragged += step.norm() * sum.squaredNorm();
    }
    return mechanical + drag * dragged;
}

}  // namespace jink::cost
