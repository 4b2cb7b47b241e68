// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/cell_spheres.hpp"

#include <algorithm>
#include <cmath>

namespace jink::reach {

CellSpheres::CellSpheres(const Grid<float>& grid) noexcept : grid_(grid)
{
    constexpr float kRounding = 1.0F + 1e-5F;
    for (std::size_t column = 0; column < grid.columns(); ++column) {
        for (std::size_t row = 0; row < grid.rows(); ++row) {
            directions_[column * grid.rows() + row] =
                from_polar(Polar<float>{1.0F, 0.5F * (grid.column_start(column) + grid.column_start(column + 1)),
                                        0.5F * (grid.row_start(row) + grid.row_start(row + 1))});
        }
    }
    const float half_width = 0.5F * (grid.column_start(1) - grid.column_start(0));
    for (std::size_t layer = 0; layer < grid.layers(); ++layer) {
        distances_[layer] = 0.5F * (grid.layer_start(layer) + grid.layer_end(layer));
    }
    for (std::size_t row = 0; row < grid.rows(); ++row) {
        const float low = grid.row_start(row);
        const float high = grid.row_start(row + 1);
        const float middle = 0.5F * (low + high);
        // The cosine of the widest angle between the middle and a corner, or the middle of an edge.
        float cosine = 1.0F;
        for (const float across : {0.0F, half_width}) {
            for (const float up : {low, middle, high}) {
                cosine = std::min(cosine,
                                  std::sin(middle) * std::sin(up) + std::cos(middle) * std::cos(up) * std::cos(across));
            }
        }
        for (std::size_t layer = 0; layer < grid.layers(); ++layer) {
            const float m = distances_[layer];
            float most = 0.0F;
            for (const float r : {grid.layer_start(layer), grid.layer_end(layer)}) {
                most = std::max(most, m * m + r * r - 2.0F * m * r * cosine);
            }
            radii_[layer * kMaxRows + row] = kRounding * std::sqrt(most);
        }
    }
}

}  // namespace jink::reach
