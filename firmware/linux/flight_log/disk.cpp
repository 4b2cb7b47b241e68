// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/disk.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace jink::flightlog {

int PosixDisk::create(const std::string& path)
{
    close();
    file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOCTTY | O_CLOEXEC, 0640);
    return file_ < 0 ? errno : 0;
}

int PosixDisk::write(std::span<const std::byte> bytes, std::size_t& written)
{
    written = 0;
    while (written < bytes.size()) {
        const ssize_t n = ::write(file_, bytes.data() + written, bytes.size() - written);
        if (n < 0 && errno != EINTR) {
            return errno;
        }
        written += n > 0 ? static_cast<std::size_t>(n) : 0U;
    }
    return 0;
}

int PosixDisk::sync()
{
    struct stat status {};
    if (::fdatasync(file_) != 0 || ::fstat(file_, &status) != 0) {
        return errno;
    }
    return status.st_nlink == 0 ? ENOENT : 0;
}

void PosixDisk::close()
{
    if (file_ >= 0) {
        ::close(file_);
        file_ = -1;
    }
}

void PosixDisk::remove(const std::string& path) { ::unlink(path.c_str()); }

std::vector<std::string> PosixDisk::names_in(const std::string& folder)
{
    std::vector<std::string> names;
    std::error_code error;
    for (auto entry = std::filesystem::directory_iterator(folder, error); !error && entry != decltype(entry)();
         entry.increment(error)) {
        names.push_back(entry->path().filename().string());
    }
    return names;
}

}  // namespace jink::flightlog
