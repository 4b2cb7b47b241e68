// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/link/cloud/frame.hpp"
#include "firmware/link/mavlink/codec.hpp"
#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"

// Common parts of the daemon's tests: a folder, a cable, the running program.

namespace jink::test {

using namespace jink::link::mavlink;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A folder that is removed at the end of the test.
class Scratch {
public:
    Scratch()
    {
        std::string name = (fs::temp_directory_path() / "jinkd_test_XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~Scratch() { fs::remove_all(path_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }

private:
    fs::path path_;
};

/// The autopilot's end of a pseudo-terminal.
class Cable {
public:
    Cable()
    {
        std::array<char, 256> name{};
        int slave = -1;
        EXPECT_EQ(openpty(&master_, &slave, name.data(), nullptr, nullptr), 0);
        fcntl(master_, F_SETFL, fcntl(master_, F_GETFL) | O_NONBLOCK);
        // Kept open, so that the line does not hang up before the daemon opens it.
        slave_ = slave;
        path_ = name.data();
    }
    ~Cable() { pull(); }
    Cable(const Cable&) = delete;
    Cable& operator=(const Cable&) = delete;

    void pull()
    {
        for (int* fd : {&slave_, &master_}) {
            if (*fd >= 0) {
                close(*fd);
                *fd = -1;
            }
        }
    }
    [[nodiscard]] const std::string& path() const { return path_; }

    template <class M>
    void send(const M& message)
    {
        std::array<std::byte, kMaxFrame> frame{};
        const Header header{1, 1, sequence_++};
        const std::size_t n =
            signing_ ? encode_signed(message, header, *signing_, frame) : encode(message, header, frame);
        send_bytes({frame.data(), n});
    }
    /// From now on the autopilot signs its frames and accepts only signed frames. Its clock starts at `time` and
    /// follows its peers.
    void sign_with(const Signing::Key& key, std::uint64_t time)
    {
        signing_ = std::make_unique<Signing>(key, std::uint8_t{0}, time);
        parser_ = std::make_unique<Parser>(signing_.get());
    }
    [[nodiscard]] const ParserDiagnostics& heard() const { return parser_->diagnostics(); }
    /// Discards output of an earlier daemon on the line.
    void drain() const
    {
        std::array<std::byte, 4096> bytes{};
        while (read(master_, bytes.data(), bytes.size()) > 0) {
        }
    }
    void send_bytes(std::span<const std::byte> bytes) const
    {
        EXPECT_EQ(write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    }

    /// Waits for a HEARTBEAT of component 196.
    std::optional<Heartbeat> heartbeat(milliseconds patience) { return wait_for<Heartbeat>(patience); }

    /// Waits for a message of component 196; returns the newest of simultaneous messages.
    template <class M>
    std::optional<M> wait_for(milliseconds patience)
    {
        const auto end = Clock::now() + patience;
        do {
            pollfd p{master_, POLLIN, 0};
            poll(&p, 1, static_cast<int>(std::min<std::int64_t>(patience.count(), 20)));
            std::array<std::byte, 4096> bytes{};
            const ssize_t n = read(master_, bytes.data(), bytes.size());
            if (n <= 0) {
                std::this_thread::sleep_for(std::min(patience, milliseconds(5)));
                continue;
            }
            std::span<const std::byte> input(bytes.data(), static_cast<std::size_t>(n));
            std::optional<M> found;
            while (const auto frame = parser_->next(input)) {
                M m;
                if (decode(*frame, m) && frame->header.component_id == 196) {
                    found = m;
                }
            }
            if (found) {
                return found;
            }
        } while (Clock::now() < end);
        return std::nullopt;
    }

private:
    int master_ = -1;
    int slave_ = -1;
    std::string path_;
    std::uint8_t sequence_ = 0;
    std::unique_ptr<Signing> signing_;
    std::unique_ptr<Parser> parser_ = std::make_unique<Parser>();
};

/// Second number of a schedstat file: ready to run, without a processor [s].
inline double waited_in(const std::string& path)
{
    double ran = 0.0;
    double waited = 0.0;
    std::ifstream(path) >> ran >> waited;
    return waited * 1e-9;
}

/// A running jinkd; its output goes to a file, to a given descriptor, or nowhere.
class Daemon {
public:
    Daemon(const std::vector<std::string>& arguments, const fs::path& output)
        : Daemon(arguments, open(output.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0644))
    {
    }
    /// `fd` becomes its standard output and error, and is closed here; -1: it has no standard output.
    Daemon(const std::vector<std::string>& arguments, int fd)
    {
        pid_ = fork();
        if (pid_ == 0) {
            ::signal(SIGPIPE, SIG_DFL);
            if (fd < 0) {
                close(STDOUT_FILENO);
            } else {
                dup2(fd, STDOUT_FILENO);
                dup2(fd, STDERR_FILENO);
            }
            // Otherwise the daemon would hold the cable's other end itself and never detect a disconnection.
            close_range(STDERR_FILENO + 1, ~0U, 0);
            std::vector<char*> argv{const_cast<char*>("jinkd")};
            for (const std::string& a : arguments) {
                argv.push_back(const_cast<char*>(a.c_str()));
            }
            argv.push_back(nullptr);
            execv(JINKD_PATH, argv.data());
            _exit(127);
        }
        close(fd);
    }
    ~Daemon()
    {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    void signal(int number) const { kill(pid_, number); }
    /// Total time that its loop was ready to run without a processor [s].
    [[nodiscard]] double waited() const { return waited_in("/proc/" + std::to_string(pid_) + "/schedstat"); }

    /// Exit status; -1 while it still runs after `patience`, 1000 + signal when it was killed.
    int wait(milliseconds patience)
    {
        const auto end = Clock::now() + patience;
        do {
            int status = 0;
            if (waitpid(pid_, &status, WNOHANG) == pid_) {
                pid_ = -1;
                return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
            }
            std::this_thread::sleep_for(milliseconds(10));
        } while (Clock::now() < end);
        return -1;
    }

private:
    pid_t pid_ = -1;
};

inline std::string text_of(const fs::path& path)
{
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

constexpr milliseconds kPatience(10'000);

}  // namespace jink::test
