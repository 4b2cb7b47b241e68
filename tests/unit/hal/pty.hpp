// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace jink::hal::test {

/// Master end of a pseudo-terminal: plays the flight controller. Its other end is the device at `path()`.
class Pty {
public:
    Pty() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC))
    {
        std::array<char, 64> name{};
        if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
            ::ptsname_r(master_, name.data(), name.size()) != 0) {
            throw std::runtime_error("no pty to be had");
        }
        path_ = name.data();
    }
    ~Pty() { hang_up(); }
    Pty(const Pty&) = delete;
    Pty& operator=(const Pty&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

    void hang_up()
    {
        if (master_ >= 0) {
            ::close(std::exchange(master_, -1));
        }
    }

    [[nodiscard]] std::size_t write(const std::byte* data, std::size_t size) const
    {
        const ssize_t put = ::write(master_, data, size);
        return put > 0 ? static_cast<std::size_t>(put) : 0;
    }

    /// Received bytes; waits up to `wait_ms` for the first byte.
    [[nodiscard]] std::vector<std::byte> read(std::size_t at_most, int wait_ms) const
    {
        std::vector<std::byte> got(at_most);
        pollfd waiting{master_, POLLIN, 0};
        const ssize_t n = ::poll(&waiting, 1, wait_ms) > 0 ? ::read(master_, got.data(), got.size()) : 0;
        got.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
        return got;
    }

private:
    int master_;
    std::string path_;
};

/// Temporary folder that is removed with its contents.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "jink-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) {
            throw std::runtime_error("no temporary folder to be had");
        }
        path_ = pattern;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;  // a folder left behind in /tmp fails no test
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

private:
    std::filesystem::path path_;
};

/// While it lives, descriptor 0 is free and the next to be opened, as in a program that was started without standard
/// input.
class FreeDescriptorZero {
public:
    FreeDescriptorZero() : kept_(::fcntl(0, F_DUPFD_CLOEXEC, 100)) { ::close(0); }
    ~FreeDescriptorZero()
    {
        if (kept_ >= 0) {
            ::dup2(kept_, 0);
            ::close(kept_);
        } else {
            ::close(0);
        }
    }
    FreeDescriptorZero(const FreeDescriptorZero&) = delete;
    FreeDescriptorZero& operator=(const FreeDescriptorZero&) = delete;

private:
    int kept_;
};

/// Drops root's rights while it exists, so that permissions apply; no effect for other users.
class AsNobody {
public:
    AsNobody() : me_(::geteuid())
    {
        if (me_ == 0 && ::seteuid(65'534) != 0) {
            throw std::runtime_error("cannot become nobody");
        }
    }
    ~AsNobody()
    {
        if (me_ == 0 && ::seteuid(me_) != 0) {
            std::abort();  // every later test would run with the wrong rights
        }
    }
    AsNobody(const AsNobody&) = delete;
    AsNobody& operator=(const AsNobody&) = delete;

private:
    uid_t me_;
};

}  // namespace jink::hal::test
