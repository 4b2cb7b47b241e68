// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace jink::sim {

/// A pseudo-terminal in raw mode; the simulator holds its master end and keeps the other one alive.
class PseudoTerminal {
public:
    /// @throws std::runtime_error when none is to be had
    PseudoTerminal();
    ~PseudoTerminal();
    PseudoTerminal(const PseudoTerminal&) = delete;
    PseudoTerminal& operator=(const PseudoTerminal&) = delete;

    /// Device for the other side.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    /// What has arrived, without waiting.
    [[nodiscard]] std::span<const std::byte> read();
    /// Bytes taken, without waiting; less than all when the other side does not read.
    [[nodiscard]] std::size_t write(std::span<const std::byte> bytes);

private:
    int master_;
    int slave_ = -1;
    std::string path_;
    std::array<std::byte, 8192> buffer_{};
};

/// A program that was started, and is killed when nobody stopped it before.
class Child {
public:
    /// Starts `arguments[0]`, from the PATH where it names no folder, with its output in `log`. @throws
    /// std::runtime_error when it cannot be started
    Child(const std::vector<std::string>& arguments, const std::filesystem::path& log);
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// True while it runs.
    [[nodiscard]] bool running();
    void ask_to_stop() const;
    struct Thread {
        double ran = 0.0;     ///< [s]
        double waited = 0.0;  ///< ready to run, until it last got a processor [s]
        bool ready = false;   ///< it runs, or waits for a processor
    };
    using Threads = std::map<pid_t, Thread>;
    /// Its threads (/proc/PID/task/*/schedstat); none where the system does not tell.
    [[nodiscard]] Threads threads() const;
    /// How it ended, in words; empty: it exited with 0. Only when it no longer runs.
    [[nodiscard]] std::string ending() const;

private:
    pid_t pid_ = -1;
    bool ended_ = false;
    int status_ = 0;
};

}  // namespace jink::sim
