// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "firmware/linux/flight_log/disk.hpp"

namespace jink::test {

/// Files in memory, with a limit and errors on demand. The test and the disk's owner share it.
struct Store {
    std::map<std::string, std::string> files;
    std::size_t capacity = ~std::size_t{0};  ///< of all files [bytes]
    int create_error = 0;
    int sync_error = 0;
    int syncs = 0;

    [[nodiscard]] std::size_t used() const
    {
        std::size_t sum = 0;
        for (const auto& [name, text] : files) {
            sum += text.size();
        }
        return sum;
    }
};

class MemoryDisk final : public flightlog::Disk {
public:
    explicit MemoryDisk(Store& store) : store_(store) {}
    int create(const std::string& path) override
    {
        const std::string name = std::filesystem::path(path).filename().string();
        if (store_.create_error != 0) {
            return store_.create_error;
        }
        if (!store_.files.emplace(name, "").second) {
            return EEXIST;
        }
        open_ = name;
        return 0;
    }
    int write(std::span<const std::byte> bytes, std::size_t& written) override
    {
        written = std::min(bytes.size(), store_.capacity - std::min(store_.capacity, store_.used()));
        store_.files.at(open_).append(reinterpret_cast<const char*>(bytes.data()), written);
        return written < bytes.size() ? ENOSPC : 0;
    }
    int sync() override
    {
        ++store_.syncs;
        return store_.sync_error;
    }
    void close() override { open_.clear(); }
    void remove(const std::string& path) override
    {
        store_.files.erase(std::filesystem::path(path).filename().string());
    }
    std::vector<std::string> names_in(const std::string& /*folder*/) override
    {
        std::vector<std::string> names;
        for (const auto& [name, text] : store_.files) {
            names.push_back(name);
        }
        return names;
    }

private:
    Store& store_;
    std::string open_;
};

}  // namespace jink::test
