#include "coppice/system/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>

#include "coppice/base/error.h"
#include "coppice/system/file.h"

namespace coppice {

std::optional<FileLock> FileLock::try_lock(const std::filesystem::path& path) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
    if (!file) throw IoError(fmt::format("cannot lock {}: {}", path.string(), file_error_text(errno)));
    if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) return std::nullopt;
    return FileLock(std::move(file));
}

}  // namespace coppice
