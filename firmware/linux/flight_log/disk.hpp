// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace jink::flightlog {

/// The file system as the writer of logs uses it; tests put another in its place. One file is open at a time. Errors
/// are those of errno; 0: none.
class Disk {
public:
    virtual ~Disk() = default;
    /// Creates and opens a file for writing; an error where it exists.
    [[nodiscard]] virtual int create(const std::string& path) = 0;
    /// @param written  number of bytes written, also on an error
    [[nodiscard]] virtual int write(std::span<const std::byte> bytes, std::size_t& written) = 0;
    /// Waits until the data are on the medium. ENOENT where the file was deleted: what is written goes nowhere.
    [[nodiscard]] virtual int sync() = 0;
    virtual void close() = 0;
    virtual void remove(const std::string& path) = 0;
    /// Names of the files in a folder.
    [[nodiscard]] virtual std::vector<std::string> names_in(const std::string& folder) = 0;
};

class PosixDisk final : public Disk {
public:
    PosixDisk() = default;
    ~PosixDisk() override { close(); }
    PosixDisk(const PosixDisk&) = delete;
    PosixDisk& operator=(const PosixDisk&) = delete;

    [[nodiscard]] int create(const std::string& path) override;
    [[nodiscard]] int write(std::span<const std::byte> bytes, std::size_t& written) override;
    [[nodiscard]] int sync() override;
    void close() override;
    void remove(const std::string& path) override;
    [[nodiscard]] std::vector<std::string> names_in(const std::string& folder) override;

private:
    int file_ = -1;
};

}  // namespace jink::flightlog
