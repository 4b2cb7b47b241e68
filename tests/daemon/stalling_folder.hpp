// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <linux/fuse.h>
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace jink::test {

/// A file system in user space (FUSE, kernel protocol 7: linux/fuse.h and Documentation/filesystems/fuse.rst) with
/// files in one folder, in memory. While it is on hold, no write and no fsync is answered: whoever calls them waits in
/// the kernel, as on a disk that does not answer.
///
/// It is mounted in a mount namespace of this process and its children, which ends with them. Where FUSE or the
/// namespace is not allowed, `why_not` says so.
class StallingFolder {
public:
    explicit StallingFolder(const std::filesystem::path& at) : at_(at)
    {
        std::filesystem::create_directory(at_);
        if (!enter_namespace()) {
            return;
        }
        device_ = ::open("/dev/fuse", O_RDWR | O_CLOEXEC);
        const std::string options = "fd=" + std::to_string(device_) +
                                    ",rootmode=40000,user_id=" + std::to_string(::getuid()) +
                                    ",group_id=" + std::to_string(::getgid());
        if (device_ < 0 || ::mount("jink", at_.c_str(), "fuse.jink", MS_NOSUID | MS_NODEV, options.c_str()) != 0) {
            why_not_ = std::string("FUSE: ") + std::strerror(errno);
            return;
        }
        server_ = std::thread([this] { serve(); });
    }
    ~StallingFolder()
    {
        if (server_.joinable()) {
            ::umount2(at_.c_str(), MNT_DETACH);
            ended_ = true;
            server_.join();
        }
        if (device_ >= 0) {
            ::close(device_);  // whoever still waits gets an error
        }
    }
    StallingFolder(const StallingFolder&) = delete;
    StallingFolder& operator=(const StallingFolder&) = delete;

    /// Empty: it works.
    [[nodiscard]] const std::string& why_not() const { return why_not_; }
    void hold() { is_on_hold_ = true; }
    void release() { is_on_hold_ = false; }
    /// Calls that wait for an answer now.
    [[nodiscard]] std::size_t waiting() const { return waiting_; }

    /// Ends the file system and writes its files to a folder. No file may be open any more.
    void end(const std::filesystem::path& folder)
    {
        ::umount2(at_.c_str(), MNT_DETACH);
        ended_ = true;
        server_.join();
        std::filesystem::create_directory(folder);
        for (const auto& [name, bytes] : files_) {
            std::ofstream(folder / name, std::ios::binary)
                .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        }
    }

private:
    using Bytes = std::vector<char>;

    [[nodiscard]] bool enter_namespace()
    {
        const uid_t user = ::getuid();
        const gid_t group = ::getgid();
        if (::unshare(user == 0 ? CLONE_NEWNS : CLONE_NEWUSER | CLONE_NEWNS) != 0) {
            why_not_ = std::string("mount namespace: ") + std::strerror(errno);
            return false;
        }
        if (user != 0) {
            const auto map = [](unsigned id) { return std::to_string(id) + " " + std::to_string(id) + " 1"; };
            std::ofstream("/proc/self/setgroups") << "deny";
            std::ofstream("/proc/self/uid_map") << map(user);
            std::ofstream("/proc/self/gid_map") << map(group);
        }
        if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) {
            why_not_ = std::string("private mounts: ") + std::strerror(errno);
            return false;
        }
        return true;
    }

    void serve()
    {
        Bytes request(1U << 18U);
        while (true) {
            if (!is_on_hold_) {
                for (Bytes& late : std::exchange(late_, {})) {
                    answer(late);
                }
                waiting_ = 0;
            }
            pollfd device{device_, POLLIN, 0};
            constexpr int kPoll = 5;  // [ms]
            if (::poll(&device, 1, kPoll) == 0) {
                if (ended_) {
                    return;
                }
                continue;
            }
            const ssize_t n = ::read(device_, request.data(), request.size());
            if (n < 0 && (errno == EINTR || errno == ENOENT || errno == EAGAIN)) {  // ENOENT: it was interrupted
                continue;
            }
            if (n < static_cast<ssize_t>(sizeof(fuse_in_header))) {
                return;  // ENODEV: it is not mounted any more
            }
            Bytes whole(request.begin(), request.begin() + n);
            const auto opcode = head_of(whole).opcode;
            if (is_on_hold_ && (opcode == FUSE_WRITE || opcode == FUSE_FSYNC)) {
                late_.push_back(std::move(whole));
                waiting_ = late_.size();
            } else {
                answer(whole);
            }
        }
    }

    [[nodiscard]] static fuse_in_header head_of(const Bytes& request) { return at<fuse_in_header>(request, 0); }
    template <class T>
    [[nodiscard]] static T at(const Bytes& request, std::size_t from)
    {
        T value{};
        std::memcpy(&value, request.data() + from,
                    std::min(sizeof value, request.size() - std::min(from, request.size())));
        return value;
    }

    void answer(const Bytes& request)
    {
        constexpr std::size_t kHead = sizeof(fuse_in_header);
        const fuse_in_header head = head_of(request);
        switch (head.opcode) {
        case FUSE_INIT: reply(head, 0, bytes_of(greeting())); break;
        case FUSE_LOOKUP: answer_entry(head, request.data() + kHead, false); break;
        case FUSE_CREATE: answer_entry(head, request.data() + kHead + sizeof(fuse_create_in), true); break;
        case FUSE_GETATTR:
        case FUSE_SETATTR: reply(head, 0, bytes_of(fuse_attr_out{0, 0, 0, attributes(head.nodeid)})); break;
        case FUSE_OPEN:
        case FUSE_OPENDIR: reply(head, 0, bytes_of(fuse_open_out{})); break;
        case FUSE_READDIR: reply(head, 0, names_from(at<fuse_read_in>(request, kHead).offset)); break;
        case FUSE_WRITE: {
            const auto in = at<fuse_write_in>(request, kHead);
            Bytes& file = files_[names_.at(head.nodeid)];
            file.resize(std::max<std::size_t>(file.size(), in.offset + in.size));
            std::memcpy(file.data() + in.offset, request.data() + kHead + sizeof in, in.size);
            reply(head, 0, bytes_of(fuse_write_out{in.size, 0}));
            break;
        }
        case FUSE_UNLINK: reply(head, files_.erase(request.data() + kHead) > 0 ? 0 : ENOENT, {}); break;
        case FUSE_FSYNC:
        case FUSE_FLUSH:
        case FUSE_RELEASE:
        case FUSE_RELEASEDIR:
        case FUSE_DESTROY: reply(head, 0, {}); break;
        case FUSE_FORGET:
        case FUSE_BATCH_FORGET:
        case FUSE_INTERRUPT: break;  // without an answer
        default: reply(head, ENOSYS, {}); break;
        }
    }

    [[nodiscard]] static fuse_init_out greeting()
    {
        fuse_init_out out{};
        out.major = FUSE_KERNEL_VERSION;
        out.minor = FUSE_KERNEL_MINOR_VERSION;
        out.flags = FUSE_BIG_WRITES;
        out.max_write = 1U << 16U;
        out.time_gran = 1;
        return out;
    }
    [[nodiscard]] fuse_attr attributes(std::uint64_t node) const
    {
        fuse_attr a{};
        a.ino = node;
        a.mode = node == FUSE_ROOT_ID ? S_IFDIR | 0755U : S_IFREG | 0640U;
        a.nlink = 1;
        a.uid = ::getuid();
        a.gid = ::getgid();
        const auto name = names_.find(node);
        const auto file = name != names_.end() ? files_.find(name->second) : files_.end();
        a.size = file != files_.end() ? file->second.size() : 0;
        return a;
    }
    void answer_entry(const fuse_in_header& head, const std::string& name, bool is_new)
    {
        if (is_new) {
            files_.try_emplace(name);
        } else if (files_.count(name) == 0) {
            reply(head, ENOENT, {});
            return;
        }
        std::uint64_t node = FUSE_ROOT_ID + 1;
        for (; names_.count(node) > 0 && names_.at(node) != name; ++node) {
        }
        names_[node] = name;
        fuse_entry_out entry{};
        entry.nodeid = node;
        entry.attr = attributes(node);
        Bytes out = bytes_of(entry);
        if (is_new) {
            const Bytes opened = bytes_of(fuse_open_out{});
            out.insert(out.end(), opened.begin(), opened.end());
        }
        reply(head, 0, out);
    }
    /// All names from the n-th on; a few files: they fit.
    [[nodiscard]] Bytes names_from(std::uint64_t n) const
    {
        Bytes out;
        std::uint64_t i = 0;
        for (const auto& [name, bytes] : files_) {
            if (i++ < n) {
                continue;
            }
            fuse_dirent entry{};
            entry.ino = i + 1;
            entry.off = i;
            entry.namelen = static_cast<std::uint32_t>(name.size());
            entry.type = S_IFREG >> 12U;
            const Bytes head = bytes_of(entry);
            out.insert(out.end(), head.begin(), head.begin() + FUSE_NAME_OFFSET);
            out.insert(out.end(), name.begin(), name.end());
            out.resize(FUSE_DIRENT_ALIGN(out.size()));
        }
        return out;
    }

    template <class T>
    [[nodiscard]] static Bytes bytes_of(const T& value)
    {
        Bytes bytes(sizeof value);
        std::memcpy(bytes.data(), &value, sizeof value);
        return bytes;
    }
    void reply(const fuse_in_header& to, int error, const Bytes& content) const
    {
        const fuse_out_header head{static_cast<std::uint32_t>(sizeof(fuse_out_header) + content.size()), -error,
                                   to.unique};
        Bytes whole = bytes_of(head);
        whole.insert(whole.end(), content.begin(), content.end());
        static_cast<void>(!::write(device_, whole.data(), whole.size()));  // fails where the caller has given up
    }

    std::filesystem::path at_;
    std::string why_not_;
    int device_ = -1;
    std::thread server_;
    std::atomic<bool> is_on_hold_{false};
    std::atomic<bool> ended_{false};
    std::atomic<std::size_t> waiting_{0};
    // The server's own.
    std::vector<Bytes> late_;
    std::map<std::uint64_t, std::string> names_;  ///< by node
    std::map<std::string, Bytes> files_;
};

}  // namespace jink::test
