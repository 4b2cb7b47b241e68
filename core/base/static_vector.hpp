// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <type_traits>

namespace jink {

/// Vector of at most N elements stored in place; named and shaped like C++26 `inplace_vector`, without exceptions.
///
/// Elements are trivially destructible and default constructible: the storage is a plain array, N * sizeof(T) bytes
/// plus one counter. `try_push_back` refuses an element when the vector is full.
template <class T, std::size_t N>
class StaticVector {
    static_assert(N >= 1);
    static_assert(std::is_trivially_destructible_v<T>);

public:
    using value_type = T;
    using iterator = T*;
    using const_iterator = const T*;

    [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }
    [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
    [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
    [[nodiscard]] constexpr bool full() const noexcept { return size_ == N; }

    /// Adds `value`; false (and nothing changed) when full.
    [[nodiscard]] constexpr bool try_push_back(const T& value) noexcept
    {
        if (full()) {
            return false;
        }
        items_[size_++] = value;
        return true;
    }

    /// Adds `value`. Precondition: the vector is not full (asserted in debug builds).
    constexpr void unchecked_push_back(const T& value) noexcept
    {
        assert(!full());
        items_[size_++] = value;
    }

    /// Removes element `i` by moving the last element into its place. O(1); the order changes.
    constexpr void swap_erase(std::size_t i) noexcept
    {
        assert(i < size_);
        items_[i] = items_[size_ - 1];
        --size_;
    }

    constexpr void pop_back() noexcept
    {
        assert(size_ > 0);
        --size_;
    }
    constexpr void clear() noexcept { size_ = 0; }

    /// Sets the size; new elements keep the previous content of the storage. n <= N.
    constexpr void resize(std::size_t n) noexcept
    {
        assert(n <= N);
        size_ = n;
    }

    [[nodiscard]] constexpr T& operator[](std::size_t i) noexcept
    {
        assert(i < size_);
        return items_[i];
    }
    [[nodiscard]] constexpr const T& operator[](std::size_t i) const noexcept
    {
        assert(i < size_);
        return items_[i];
    }
    [[nodiscard]] constexpr T& front() noexcept { return (*this)[0]; }
    [[nodiscard]] constexpr const T& front() const noexcept { return (*this)[0]; }
    [[nodiscard]] constexpr T& back() noexcept { return (*this)[size_ - 1]; }
    [[nodiscard]] constexpr const T& back() const noexcept { return (*this)[size_ - 1]; }

    [[nodiscard]] constexpr iterator begin() noexcept { return items_.data(); }
    [[nodiscard]] constexpr iterator end() noexcept { return items_.data() + size_; }
    [[nodiscard]] constexpr const_iterator begin() const noexcept { return items_.data(); }
    [[nodiscard]] constexpr const_iterator end() const noexcept { return items_.data() + size_; }
    [[nodiscard]] constexpr T* data() noexcept { return items_.data(); }
    [[nodiscard]] constexpr const T* data() const noexcept { return items_.data(); }

private:
    std::array<T, N> items_{};
    std::size_t size_ = 0;
};

}  // namespace jink
