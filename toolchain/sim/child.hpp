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

/// A pseudo-terminal in raw mode. The simulator holds its master end and keeps the slave end open.
class PseudoTerminal {
public:
    /// @throws std::runtime_error when no pseudo-terminal is available
    PseudoTerminal();
    ~PseudoTerminal();
    PseudoTerminal(const PseudoTerminal&) = delete;
    PseudoTerminal& operator=(const PseudoTerminal&) = delete;

    /// Device for the other side.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    /// Bytes received so far. Does not block.
    [[nodiscard]] std::span<const std::byte> read();
    /// Does not block. @return bytes accepted; fewer than given when the other side does not read
    [[nodiscard]] std::size_t write(std::span<const std::byte> bytes);

private:
    int master_;
    int slave_ = -1;
    std::string path_;
    std::array<std::byte, 8192> buffer_{};
};

/// A started program. The destructor kills a program that still runs.
class Child {
public:
    /// Starts `arguments[0]` with its output in `log`. A name without a folder is searched in PATH. @throws
    /// std::runtime_error when the program cannot be started
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
        bool ready = false;   ///< running, or waiting for a processor
    };
    using Threads = std::map<pid_t, Thread>;
    /// The program's threads (/proc/PID/task/*/schedstat); empty where the system does not report them.
    [[nodiscard]] Threads threads() const;
    /// How the program ended, in words; empty: exit status 0. Call only after the program ended.
    [[nodiscard]] std::string ending() const;

private:
    pid_t pid_ = -1;
    bool ended_ = false;
    int status_ = 0;
};

}  // namespace jink::sim
