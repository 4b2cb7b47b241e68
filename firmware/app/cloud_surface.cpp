// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud_surface.hpp"

#include <algorithm>
#include <cmath>

namespace jink::app {
namespace {

constexpr float kAxisAngle = kPi / static_cast<float>(CloudSurface::kAxes);

struct LevelAxis {
    float cosine;
    float sine;
};
/// At k * kAxisAngle.
constexpr std::array<LevelAxis, CloudSurface::kAxes> kAxisOf{{{1.0F, 0.0F},
                                                              {0.92387953F, 0.38268343F},
                                                              {0.70710678F, 0.70710678F},
                                                              {0.38268343F, 0.92387953F},
                                                              {0.0F, 1.0F},
                                                              {-0.38268343F, 0.92387953F},
                                                              {-0.70710678F, 0.70710678F},
                                                              {-0.92387953F, 0.38268343F}}};

}  // namespace

CloudMoments& CloudMoments::operator+=(const CloudMoments& other) noexcept
{
    n += other.n;
    x += other.x;
    y += other.y;
    z += other.z;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    zz += other.zz;
    return *this;
}

CloudMoments::Spread CloudMoments::spread() const noexcept
{
    return n > 0.0 ? Spread{xx - x * x / n, xy - x * y / n, yy - y * y / n} : Spread{};
}

float CloudMoments::direction() const noexcept
{
    const Spread s = spread();
    const auto angle = static_cast<float>(0.5 * std::atan2(2.0 * s.xy, s.xx - s.yy));
    return angle < 0.0F ? angle + kPi : angle;
}

double CloudMoments::residual() const noexcept
{
    const Spread s = spread();
    const double upright = 0.5 * (s.xx + s.yy - std::hypot(s.xx - s.yy, 2.0 * s.xy));
    const double level = n > 0.0 ? zz - z * z / n : 0.0;
    return std::max(0.0, std::min(upright, level));
}

double CloudMoments::square_range() const noexcept { return n > 0.0 ? (xx + yy + zz) / n : 0.0; }

void Interval::add(float from, float to) noexcept
{
    low = std::min(low, from);
    high = std::max(high, to);
}

void CloudSurface::add(const Vec3& point, float radius) noexcept
{
    for (std::size_t k = 0; k < kAxes; ++k) {
        const float t = kAxisOf[k].cosine * point.x() + kAxisOf[k].sine * point.y();
        level_[k].add(t - radius, t + radius);
    }
    height_.add(point.z() - radius, point.z() + radius);
    const float range = point.norm();
    range_.add(range - radius, range + radius);
    // The sphere's own spread: a third of the squared radius along each axis, that of its surface.
    const float own = radius * radius / 3.0F;
    const Vec3& p = point;
    add_means(1.0F,
              {p.x(), p.y(), p.z(), p.x() * p.x() + own, p.x() * p.y(), p.y() * p.y() + own, p.z() * p.z() + own});
}

void CloudSurface::add_means(float n, const std::array<float, 7>& means) noexcept
{
    n_ += n;
    for (std::size_t i = 0; i < means.size(); ++i) {
        means_[i] += (means[i] - means_[i]) * (n / n_);
    }
}

CloudMoments CloudSurface::moments() const noexcept
{
    return has_points() ? CloudMoments{1.0, means_[0], means_[1], means_[2], means_[3], means_[4], means_[5], means_[6]}
                        : CloudMoments{};
}

/// A direction between two axes is a sum of both with weights of 0 and more, and so are the bounds along it.
Interval CloudSurface::along(float angle) const noexcept
{
    const float steps = std::max(angle, 0.0F) / kAxisAngle;
    const std::size_t k = std::min(static_cast<std::size_t>(steps), kAxes - 1);
    const float past = std::clamp(angle - static_cast<float>(k) * kAxisAngle, 0.0F, kAxisAngle);
    const float first = std::sin(kAxisAngle - past) / std::sin(kAxisAngle);
    const float second = std::sin(past) / std::sin(kAxisAngle);
    const Interval& a = level_[k];
    // Half a turn on, an axis points the other way.
    const Interval b = k + 1 < kAxes ? level_[k + 1] : Interval{-level_[0].high, -level_[0].low};
    return {first * a.low + second * b.low, first * a.high + second * b.high};
}

Vec3 CloudSurface::middle() const noexcept
{
    const Interval& x = level_[0];
    const Interval& y = level_[kAxes / 2];
    return 0.5F * Vec3(x.low + x.high, y.low + y.high, height_.low + height_.high);
}

float CloudSurface::radius() const noexcept
{
    const Interval& x = level_[0];
    const Interval& y = level_[kAxes / 2];
    return 0.5F * Vec3(x.high - x.low, y.high - y.low, height_.high - height_.low).norm();
}

void CloudSurface::add(const CloudSurface& other) noexcept
{
    for (std::size_t k = 0; k < kAxes; ++k) {
        level_[k].add(other.level_[k].low, other.level_[k].high);
    }
    height_.add(other.height_.low, other.height_.high);
    range_.add(other.range_.low, other.range_.high);
    add_means(other.n_, other.means_);
}

float CloudSurface::patch_depth(float nearest) noexcept { return std::max(kMinDepth, kDepthShare * nearest); }

float CloudSurface::gap_to(const CloudSurface& other) const noexcept
{
    return std::max({range_.low - other.range_.high, other.range_.low - range_.high, 0.0F});
}

bool CloudSurface::is_close_to(const CloudSurface& other) const noexcept
{
    return has_points() && other.has_points() && gap_to(other) <= patch_depth(std::min(range_.low, other.range_.low));
}

void CloudBin::add(const Vec3& point, float radius) noexcept
{
    state = State::hit;
    CloudSurface added;
    added.add(point, radius);
    CloudSurface& nearer = layers[0];
    CloudSurface& farther = layers[1];
    const auto apart = [](const CloudSurface& a, const CloudSurface& b) {
        return a.gap_to(b) / std::max(std::min(a.range().high, b.range().high), 1.0F);
    };
    if (!nearer.has_points() || nearer.is_close_to(added)) {
        nearer.add(added);
    } else if (farther.is_close_to(added)) {
        farther.add(added);
    } else if (!farther.has_points()) {
        farther = added;
    } else if (apart(nearer, farther) < std::min(apart(nearer, added), apart(farther, added))) {
        nearer.add(farther);
        farther = added;
    } else {
        (apart(nearer, added) <= apart(farther, added) ? nearer : farther).add(added);
    }
    if (farther.has_points() && farther.range().low < nearer.range().low) {
        std::swap(nearer, farther);
    }
}

}  // namespace jink::app
