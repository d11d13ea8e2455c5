#include "coppice/system/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/system/descriptor.h"

namespace coppice {
namespace {

// [bytes] size of the write buffer; larger blocks are written directly
constexpr std::size_t kGather = std::size_t{1} << 18;
constexpr const char* kOwnDescriptors = "/proc/self/fd";
constexpr std::size_t kTransfer = std::size_t{1} << 26;  // [bytes] maximum size of a system call

[[noreturn]] void fail(std::string_view action, const std::filesystem::path& path, std::string_view reason) {
    throw IoError(fmt::format("cannot {} {}: {}", action, path.string(), reason));
}

/// Waits until a pipe has data or has ended; returns at once for other files.
void wait_for_bytes(int descriptor, const Context& ctx) {
    constexpr int kPollInterval = 100;  // [ms]
    pollfd waiting{descriptor, POLLIN, 0};
    do {
        ctx.throw_if_cancelled();
    } while (::poll(&waiting, 1, kPollInterval) == 0);
}

/// Reads once, and again if a signal interrupts the call.
std::size_t read_some(int descriptor, char* to, std::size_t size, const std::filesystem::path& path,
                      const Context& ctx) {
    for (;;) {
        wait_for_bytes(descriptor, ctx);
        const ssize_t got = ::read(descriptor, to, std::min(size, kTransfer));
        if (got >= 0) return static_cast<std::size_t>(got);
        if (errno != EINTR && errno != EAGAIN) fail("read", path, file_error_text(errno));
    }
}

std::string too_large(std::uint64_t limit) {
    constexpr std::uint64_t kMebi = std::uint64_t{1} << 20;
    return limit % kMebi == 0 ? fmt::format("it is larger than {} MiB", limit / kMebi)
                              : fmt::format("it is larger than {} bytes", limit);
}

}  // namespace

std::string file_error_text(int error) {
    switch (error) {
        case ENOENT:
            return "there is no such file or folder";
        case ENOTDIR:
            return "a component of its path is not a folder";
        case EISDIR:
            return "it is a folder, not a file";
        case EACCES:
        case EPERM:
            return "permission denied";
        case EROFS:
            return "the file system is read-only";
        case ENOSPC:
        case EDQUOT:
            return "no space is left on the disk";
        case EFBIG:
            return "it would exceed the maximum file size of this process (see ulimit -f)";
        case EBADF:
            return "it is closed";
        case ENAMETOOLONG:
            return "its name is too long";
        default:
            return std::generic_category().message(error);
    }
}

std::string read_file(const std::filesystem::path& path, std::uint64_t limit, const Context& ctx) {
    // Without O_NONBLOCK, opening a pipe without a writer would block and ignore cancellation.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat status {};
    if (!file || ::fstat(file.get(), &status) != 0) fail("read", path, file_error_text(errno));
    if (S_ISDIR(status.st_mode)) fail("read", path, file_error_text(EISDIR));
    const auto size = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
    if (size == 0) limit = std::min(limit, kLargestStream);
    if (size > limit) fail("read", path, too_large(limit));

    // The additional byte detects the end of the file without growing the buffer. Pipes and growing files
    // continue up to one byte above the limit.
    std::string bytes(size + 1, '\0');
    std::size_t used = 0;
    while (const std::size_t got =
               read_some(file.get(), bytes.data() + used, bytes.size() - used, path, ctx)) {
        used += got;
        if (used > limit) fail("read", path, too_large(limit));
        if (used == bytes.size()) {
            bytes.resize(std::min<std::uint64_t>(std::max<std::size_t>(2 * used, 4096) - 1, limit) + 1);
        }
    }
    bytes.resize(used);
    return bytes;
}

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
    std::error_code ignored;
    if (target_.filename().empty()) fail("write", target_, "the path has no file name");
    if (std::filesystem::is_symlink(target_, ignored)) {
        const auto linked = std::filesystem::weakly_canonical(target_, ignored);
        if (!ignored) target_ = linked;
    }
    struct stat status {};
    const bool exists = ::stat(target_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) fail("write", target_, file_error_text(EISDIR));
    if (exists && ::access(target_.c_str(), W_OK) != 0) fail("write", target_, file_error_text(errno));
    if (exists && !S_ISREG(status.st_mode)) {
        descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) fail("write", target_, file_error_text(errno));
        return;
    }
    folder_ = target_.has_parent_path() ? target_.parent_path() : ".";
    open_unfinished();
    if (exists) static_cast<void>(::fchmod(descriptor_, status.st_mode & 07777));
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!unfinished_.empty()) ::unlink(unfinished_.c_str());
}

/// Calls make(name) with successive hidden names until it returns true or fails for a reason other than that
/// the name exists. mkstemp is not used because it ignores the umask. Several files and processes may write
/// to the same folder concurrently.
template <class Make>
bool AtomicFile::make_hidden(const Make& make) {
    for (unsigned attempt = 0;; ++attempt) {
        auto name = folder_ / fmt::format(".coppice-{}-{}.part", ::getpid(), attempt);
        if (make(name.c_str())) {
            unfinished_ = std::move(name);
            return true;
        }
        if (errno != EEXIST && errno != EINTR) return false;
    }
}

void AtomicFile::open_unfinished() {
#ifdef O_TMPFILE
    if (::access(kOwnDescriptors, X_OK) == 0)
        descriptor_ = ::open(folder_.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) return;
#endif
    const bool made = make_hidden([&](const char* name) {
        descriptor_ = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        return descriptor_ >= 0;
    });
    if (made) return;
    if (errno == ENOENT) fail("write", target_, "its folder does not exist; create it first");
    if (errno == EACCES) fail("write", target_, "its folder is not writable");
    fail("write", target_, file_error_text(errno));
}

/// Links the file to a hidden name first, because only a rename can replace an existing name.
void AtomicFile::give_name() {
    const std::string own = fmt::format("{}/{}", kOwnDescriptors, descriptor_);
    const bool made = make_hidden([&](const char* name) {
        return ::linkat(AT_FDCWD, own.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
    });
    if (!made) fail("write", target_, file_error_text(errno));
}

void AtomicFile::write(std::string_view text) {
    if (gathered_.size() + text.size() > kGather) flush();
    if (text.size() >= kGather) {
        write_through(text);
    } else {
        gathered_.append(text);
    }
}

void AtomicFile::write(std::span<const std::byte> bytes) {
    write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void AtomicFile::write_through(std::string_view bytes) {
    COPPICE_ASSERT(descriptor_ >= 0);
    while (!bytes.empty()) {
        const ssize_t done = ::write(descriptor_, bytes.data(), std::min(bytes.size(), kTransfer));
        if (done >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(done));
        } else if (errno != EINTR) {
            fail("write", target_, file_error_text(errno));
        }
    }
}

void AtomicFile::flush() {
    write_through(gathered_);
    gathered_.clear();
}

void AtomicFile::commit() {
    flush();
    if (!folder_.empty() && unfinished_.empty()) give_name();
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("write", target_, file_error_text(errno));
    if (folder_.empty()) return;
    if (::rename(unfinished_.c_str(), target_.c_str()) != 0) fail("write", target_, file_error_text(errno));
    unfinished_.clear();
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace coppice
