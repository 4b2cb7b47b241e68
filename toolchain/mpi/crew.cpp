// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mpi/crew.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include <mpi.h>

namespace jink::mpi {
namespace {

/// Largest size of a message [bytes].
constexpr std::size_t kMax = std::numeric_limits<int>::max();

int length_of(const std::string& piece)
{
    if (piece.size() > kMax) {
        throw std::length_error("a piece of more than 2 GiB");
    }
    return static_cast<int>(piece.size());
}

}  // namespace

/// A counter in the leader's memory, accessible to every process.
struct Crew::Counter {
    explicit Counter(bool leads)
    {
        const MPI_Aint bytes = leads ? static_cast<MPI_Aint>(sizeof(std::uint64_t)) : 0;
        MPI_Win_allocate(bytes, sizeof(std::uint64_t), MPI_INFO_NULL, MPI_COMM_WORLD, &memory, &window);
        MPI_Win_lock_all(0, window);
        if (leads) {
            *memory = 0;
            MPI_Win_sync(window);
        }
        MPI_Barrier(MPI_COMM_WORLD);
    }
    Counter(const Counter&) = delete;
    Counter& operator=(const Counter&) = delete;
    ~Counter()
    {
        MPI_Win_unlock_all(window);
        MPI_Win_free(&window);
    }

    std::uint64_t* memory = nullptr;
    MPI_Win window = MPI_WIN_NULL;
};

Crew::Crew(int& argc, char**& argv)
{
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Crew::~Crew()
{
    counter_.reset();
    MPI_Finalize();
}

void Crew::share(std::vector<std::uint64_t>& values) const
{
    std::uint64_t count = values.size();
    MPI_Bcast(&count, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    values.resize(count);
    for (std::size_t at = 0; at < values.size(); at += kMax) {
        const std::size_t n = std::min(kMax, values.size() - at);
        MPI_Bcast(values.data() + at, static_cast<int>(n), MPI_UINT64_T, 0, MPI_COMM_WORLD);
    }
}

void Crew::share(std::string& text) const
{
    std::uint64_t size = text.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    text.resize(size);
    MPI_Bcast(text.data(), length_of(text), MPI_CHAR, 0, MPI_COMM_WORLD);
}

void Crew::begin_count()
{
    counter_.reset();
    counter_ = std::make_unique<Counter>(leads());
}

std::uint64_t Crew::next()
{
    const std::uint64_t one = 1;
    std::uint64_t number = 0;
    MPI_Fetch_and_op(&one, &number, MPI_UINT64_T, 0, 0, MPI_SUM, counter_->window);
    MPI_Win_flush(0, counter_->window);
    return number;
}

void Crew::attend() const
{
    int waits = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &waits, MPI_STATUS_IGNORE);
}

void Crew::meet() const { MPI_Barrier(MPI_COMM_WORLD); }

std::vector<std::string> Crew::gather(const std::vector<std::string>& pieces) const
{
    std::uint64_t count = pieces.size();
    if (!leads()) {
        MPI_Send(&count, 1, MPI_UINT64_T, 0, 0, MPI_COMM_WORLD);
        for (const std::string& piece : pieces) {
            MPI_Send(piece.data(), length_of(piece), MPI_CHAR, 0, 0, MPI_COMM_WORLD);
        }
        return {};
    }
    std::vector<std::string> all = pieces;
    for (int from = 1; from < size_; ++from) {
        MPI_Recv(&count, 1, MPI_UINT64_T, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        for (std::uint64_t i = 0; i < count; ++i) {
            MPI_Status status;
            int bytes = 0;
            MPI_Probe(from, 0, MPI_COMM_WORLD, &status);
            MPI_Get_count(&status, MPI_CHAR, &bytes);
            std::string piece(static_cast<std::size_t>(bytes), '\0');
            MPI_Recv(piece.data(), bytes, MPI_CHAR, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            all.push_back(std::move(piece));
        }
    }
    return all;
}

void Crew::abandon(int status) const
{
    MPI_Abort(MPI_COMM_WORLD, status);
    std::abort();
}

}  // namespace jink::mpi
