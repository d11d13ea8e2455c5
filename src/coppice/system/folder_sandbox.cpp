#include "coppice/system/folder_sandbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/system/folder_sandbox_internal.h"

#if __has_include(<linux/openat2.h>)
#include <linux/openat2.h>
#include <sys/syscall.h>
#endif

namespace coppice {
namespace system_internal {
namespace {

constexpr std::size_t kLongestName = 1024;  // [bytes]

/// Returns the components of a path, without ".".
std::vector<std::string> split_name(std::string_view name) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= name.size();) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        if (const auto part = name.substr(begin, end - begin); part != ".") parts.emplace_back(part);
        begin = end + 1;
    }
    return parts;
}

/// Returns the number of bytes of the first UTF-8 character of a text; 0 if it is invalid.
std::size_t size_of_character(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const auto goes_on = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    if (first >= 0xc2 && first < 0xe0) return goes_on(1) ? 2 : 0;
    if (first >= 0xe0 && first < 0xf0) {
        const bool overlong = first == 0xe0 && byte(1) < 0xa0, surrogate = first == 0xed && byte(1) >= 0xa0;
        return goes_on(1) && goes_on(2) && !overlong && !surrogate ? 3 : 0;
    }
    if (first >= 0xf0 && first < 0xf5) {
        const bool overlong = first == 0xf0 && byte(1) < 0x90, beyond = first == 0xf4 && byte(1) >= 0x90;
        return goes_on(1) && goes_on(2) && goes_on(3) && !overlong && !beyond ? 4 : 0;
    }
    return 0;
}

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const std::size_t size = size_of_character(text);
        if (size == 0) return false;
        text.remove_prefix(size);
    }
    return true;
}

}  // namespace

std::string_view fault_of_name(std::string_view name) {
    if (name.empty()) return "the name is empty";
    if (name.size() > kLongestName) return "the name is too long";
    if (name.front() == '/') return "only files of the opened folder may be used, by names relative to it";
    if (std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
        return "the name has control characters";
    if (!is_utf8(name)) return "the name is not valid UTF-8";
    const auto parts = split_name(name);
    if (parts.empty()) return "the name is that of the folder itself";
    for (const std::string& part : parts) {
        if (part.empty()) return "the name has an empty component";
        if (part == "..") return "it is outside the opened folder";
        if (part.front() == '.') return "hidden files may not be used";
    }
    return {};
}

int open_stepwise(int folder, const std::string& name, int flags) {
    const auto parts = split_name(name);
    if (parts.empty()) return ::openat(folder, ".", flags);
    Descriptor at;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const bool last = i + 1 == parts.size();
        const int how = last ? flags : O_PATH | O_CLOEXEC;
        const int from = i == 0 ? folder : at.get();
        Descriptor next(::openat(from, parts[i].c_str(), how | O_NOFOLLOW));
        if (!next) return -1;
        // O_PATH opens a symbolic link itself.
        struct stat status {};
        if (::fstat(next.get(), &status) != 0) return -1;
        if (S_ISLNK(status.st_mode)) {
            errno = ELOOP;
            return -1;
        }
        at = std::move(next);
    }
    return at.release();
}

int open_beneath(int folder, const std::string& name, int flags) {
#ifdef RESOLVE_BENEATH
    open_how how{};
    how.flags = static_cast<std::uint64_t>(flags);
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS;
    const long opened = ::syscall(SYS_openat2, folder, name.c_str(), &how, sizeof how);
    // Process sandboxes that do not support the call refuse it with EPERM.
    if (opened >= 0 || (errno != ENOSYS && errno != EPERM)) return static_cast<int>(opened);
#endif
    return open_stepwise(folder, name, flags);
}

namespace {

[[noreturn]] void refuse(std::string_view action, std::string_view name, std::string_view why) {
    throw IoError(fmt::format("cannot {} {}: {}", action, quote(printable(name)), why));
}

[[noreturn]] void refuse(std::string_view action, std::string_view name, int error) {
    switch (error) {
        case ENOENT:
            refuse(action, name, "there is no such file or folder");
        case ENOTDIR:
            refuse(action, name, "a component of its path is not a folder");
        case ELOOP:
        case EXDEV:
            refuse(action, name,
                   "symbolic links are not followed, neither out of nor within the opened folder");
        case EACCES:
        case EPERM:
            refuse(action, name, "permission denied");
        default:
            refuse(action, name, std::generic_category().message(error));
    }
}

void check_name(std::string_view action, std::string_view name) {
    if (const auto fault = fault_of_name(name); !fault.empty()) refuse(action, name, fault);
}

/// Splits a path into its folder and its last component: "a/b" into "a" and "b", "b" into "." and "b".
std::pair<std::string, std::string> split(std::string_view name) {
    const auto parts = split_name(name);
    const std::string folder = fmt::format("{}", fmt::join(parts.begin(), parts.end() - 1, "/"));
    return {folder.empty() ? "." : folder, parts.back()};
}

}  // namespace
}  // namespace system_internal

using namespace system_internal;

FolderSandbox::FolderSandbox(const std::filesystem::path& folder,
                             const std::vector<std::filesystem::path>& allowed) {
    std::error_code error;
    folder_ = std::filesystem::canonical(folder.empty() ? "." : folder, error);
    if (!error) descriptor_ = Descriptor(::open(folder_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!descriptor_) refuse("open", folder.string(), error ? error.value() : errno);
    for (const auto& file : allowed) allowed_.push_back(std::filesystem::absolute(file).lexically_normal());
}

bool FolderSandbox::is_allowed(const std::filesystem::path& name) const {
    const auto whole = (folder_ / name).lexically_normal();
    return std::ranges::find(allowed_, whole) != allowed_.end();
}

std::filesystem::path FolderSandbox::to_read(std::string_view name) const {
    if (!name.empty() && is_allowed(name)) return (folder_ / name).lexically_normal();
    check_name("read", name);
    const Descriptor file(open_beneath(descriptor_.get(), std::string(name), O_PATH | O_CLOEXEC));
    struct stat status {};
    if (!file || ::fstat(file.get(), &status) != 0) refuse("read", name, errno);
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        refuse("read", name, "it is neither a file nor a folder");
    return (folder_ / name).lexically_normal();
}

std::filesystem::path FolderSandbox::to_write(std::string_view name) const {
    check_name("write", name);
    const auto [folder, file] = split(name);
    const Descriptor within(open_beneath(descriptor_.get(), folder, O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!within && errno == ENOENT) refuse("write", name, "its folder does not exist");
    if (!within) refuse("write", name, errno);
    struct stat status {};
    if (::fstatat(within.get(), file.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0) {
        if (S_ISLNK(status.st_mode)) refuse("write", name, ELOOP);
        if (!S_ISREG(status.st_mode)) refuse("write", name, "a folder or special file of this name exists");
    } else if (errno != ENOENT) {
        refuse("write", name, errno);
    }
    return (folder_ / name).lexically_normal();
}

Descriptor FolderSandbox::open(std::string_view name) const {
    check_name("read", name);
    // Without O_NONBLOCK, opening a pipe without a writer would block.
    Descriptor file(open_beneath(descriptor_.get(), std::string(name), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (!file || ::fstat(file.get(), &status) != 0) refuse("read", name, errno);
    if (!S_ISREG(status.st_mode)) refuse("read", name, "it is not a file");
    return file;
}

}  // namespace coppice
