// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <initializer_list>
#include <type_traits>

// Functions that mutated sources call in place of operators (toolchain/mutation/mutate). Never part of a product.
//
// Every function computes the operator as written, or the wrong answer selected by JINK_MUTANT. While recording, it
// notes for each of its mutants whether the wrong answer ever differed from the right one. A test without a difference
// cannot detect the mutant and need not be run against it.

namespace jink_mutation {

extern const int active;         ///< number of the active mutant; 0: none
extern const bool recording;     ///< JINK_MUTATION_RECORD names a file for the differences
extern unsigned char differs[];  ///< by mutant

/// As a value: evaluates an Eigen expression, so that two expressions of different types are interchangeable.
template <class T>
[[nodiscard]] constexpr auto value(const T& x)
{
    if constexpr (requires { x.eval(); }) {
        return x.eval();
    } else {
        return x;
    }
}

template <class T>
[[nodiscard]] bool are_different(const T& a, const T& b)
{
    if constexpr (requires { (a.array() != b.array()).any(); }) {
        return (a.array() != b.array()).any();
    } else {
        return !(a == b);
    }
}

template <int kMutant, class T>
void note(const T& right, const T& wrong)
{
    if (are_different(right, wrong)) {
        differs[kMutant] = 1;
    }
}

/// One mutant.
template <int kMutant, class T>
[[nodiscard]] T one(const T& right, const T& wrong)
{
    if (recording) {
        note<kMutant>(right, wrong);
    }
    return active == kMutant ? wrong : right;
}

/// Two mutants, kMutant and the next.
template <int kMutant, class T>
[[nodiscard]] T two(const T& right, const T& wrong, const T& other)
{
    if (recording) {
        note<kMutant>(right, wrong);
        note<kMutant + 1>(right, other);
    }
    return active == kMutant ? wrong : active == kMutant + 1 ? other : right;
}

template <int kMutant, class A, class B>
[[nodiscard]] auto less(const A& a, const B& b)
{
    return two<kMutant>(value(a < b), value(a <= b), value(a >= b));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto less_equal(const A& a, const B& b)
{
    return two<kMutant>(value(a <= b), value(a < b), value(a > b));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto greater(const A& a, const B& b)
{
    return two<kMutant>(value(a > b), value(a >= b), value(a <= b));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto greater_equal(const A& a, const B& b)
{
    return two<kMutant>(value(a >= b), value(a > b), value(a < b));
}
template <int kMutant, class A, class B>
[[nodiscard]] bool equal(const A& a, const B& b)
{
    return two<kMutant>(static_cast<bool>(a == b), true, false);
}
template <int kMutant, class A, class B>
[[nodiscard]] bool not_equal(const A& a, const B& b)
{
    return two<kMutant>(static_cast<bool>(a != b), true, false);
}

/// a && b (kSettles: false) or a || b (true), which `a` settles when it is kSettles. Mutants: a alone, b alone. `b`
/// alone may be evaluated outside its precondition `a`; only the mutant does that. kActs: an operand has a side effect
/// (spends a budget), so that omitting it may be noticed for any result.
template <int kMutant, bool kSettles, bool kActs, class A, class B>
[[nodiscard]] bool connected(const A& a, const B& b)
{
    if (active == kMutant + 1) {
        return b();
    }
    const bool first = a();
    if (recording && (kActs || first == kSettles)) {
        differs[kMutant + 1] = 1;  // may differ
    }
    if (first == kSettles || active == kMutant) {
        return first;
    }
    const bool second = b();
    if (recording && (kActs || second == kSettles)) {
        differs[kMutant] = 1;
    }
    return second;
}
template <int kMutant, class A, class B>
[[nodiscard]] bool both(const A& a, const B& b)
{
    return connected<kMutant, false, false>(a, b);
}
template <int kMutant, class A, class B>
[[nodiscard]] bool both_acting(const A& a, const B& b)
{
    return connected<kMutant, false, true>(a, b);
}
template <int kMutant, class A, class B>
[[nodiscard]] bool either(const A& a, const B& b)
{
    return connected<kMutant, true, false>(a, b);
}
template <int kMutant, class A, class B>
[[nodiscard]] bool either_acting(const A& a, const B& b)
{
    return connected<kMutant, true, true>(a, b);
}
/// The same of arrays, element by element.
template <int kMutant, class A, class B>
[[nodiscard]] auto both_of(const A& a, const B& b)
{
    return two<kMutant>(value(a && b), value(a), value(b));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto either_of(const A& a, const B& b)
{
    return two<kMutant>(value(a || b), value(a), value(b));
}

template <int kMutant, class A>
[[nodiscard]] bool negation(const A& a)
{
    const bool is = static_cast<bool>(a);
    return one<kMutant>(!is, is);
}
/// A condition that is not an operator: taken, not taken. For any type that converts to bool.
template <int kMutant, class A>
[[nodiscard]] bool condition(const A& a)
{
    return two<kMutant>(static_cast<bool>(a), true, false);
}

/// Bounds dropped.
template <int kMutant, class T>
[[nodiscard]] T min(const T& a, const T& b)
{
    return two<kMutant>(std::min(a, b), a, b);
}
template <int kMutant, class T>
[[nodiscard]] T max(const T& a, const T& b)
{
    return two<kMutant>(std::max(a, b), a, b);
}
template <int kMutant, class T>
[[nodiscard]] T clamp(const T& x, const T& low, const T& high)
{
    return two<kMutant>(std::clamp(x, low, high), std::min(x, high), std::max(x, low));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto cwise_min(const A& a, const B& b)
{
    return one<kMutant>(value(a.cwiseMin(b)), value(a));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto cwise_max(const A& a, const B& b)
{
    return one<kMutant>(value(a.cwiseMax(b)), value(a));
}
/// The same under the names of the array functions.
template <int kMutant, class A, class B>
[[nodiscard]] auto array_min(const A& a, const B& b)
{
    return one<kMutant>(value(a.min(b)), value(a));
}
template <int kMutant, class A, class B>
[[nodiscard]] auto array_max(const A& a, const B& b)
{
    return one<kMutant>(value(a.max(b)), value(a));
}
template <int kMutant, class A>
[[nodiscard]] auto min_coefficient(const A& a)
{
    return one<kMutant>(a.minCoeff(), a.maxCoeff());
}
template <int kMutant, class A>
[[nodiscard]] auto max_coefficient(const A& a)
{
    return one<kMutant>(a.maxCoeff(), a.minCoeff());
}
/// Mutant kMutant + i leaves element i out; of two elements at least.
template <int kMutant, class T, class Choose>
[[nodiscard]] T of_list(std::initializer_list<T> list, const Choose& choose)
{
    const T right = choose(list.begin(), list.end(), list.end());
    T answer = right;
    for (const T* left_out = list.begin(); left_out != list.end(); ++left_out) {
        const int mutant = kMutant + static_cast<int>(left_out - list.begin());
        const T wrong = choose(list.begin(), list.end(), left_out);
        if (recording && are_different(right, wrong)) {
            differs[mutant] = 1;
        }
        answer = active == mutant ? wrong : answer;
    }
    return answer;
}
template <int kMutant, class T>
[[nodiscard]] T min(std::initializer_list<T> list)
{
    return of_list<kMutant>(list, [](const T* i, const T* end, const T* without) {
        i += i == without ? 1 : 0;
        T least = *i;
        for (; i != end; ++i) {
            least = i == without ? least : std::min(least, *i);
        }
        return least;
    });
}
template <int kMutant, class T>
[[nodiscard]] T max(std::initializer_list<T> list)
{
    return of_list<kMutant>(list, [](const T* i, const T* end, const T* without) {
        i += i == without ? 1 : 0;
        T most = *i;
        for (; i != end; ++i) {
            most = i == without ? most : std::max(most, *i);
        }
        return most;
    });
}

/// Signs.
template <int kMutant, class A>
[[nodiscard]] auto minus(const A& a)
{
    return one<kMutant>(value(-a), value(a));
}
template <int kMutant, class A>
[[nodiscard]] auto magnitude(const A& a)
{
    return one<kMutant>(std::abs(a), a);
}
template <int kMutant, class A, class B>
[[nodiscard]] auto sum(const A& a, const B& b)
{
    return one<kMutant>(a + b, a - b);
}
template <int kMutant, class A, class B>
[[nodiscard]] auto difference(const A& a, const B& b)
{
    return one<kMutant>(a - b, a + b);
}

}  // namespace jink_mutation
