#include "journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <system_error>

namespace coppice::server {
namespace {

constexpr int kMaxPlaces = 64;

std::filesystem::path state_folder() {
    const char* state = std::getenv("XDG_STATE_HOME");
    if (state != nullptr && *state == '/') return std::filesystem::path(state) / "coppice/studio";
    const char* home = std::getenv("HOME");
    if (home == nullptr || *home != '/') return {};
    return std::filesystem::path(home) / ".local/state/coppice/studio";
}

/// FNV-1a: returns the same hash for a name on every run.
std::uint64_t compute_hash(const std::string& text) {
    std::uint64_t hash = 14695981039346656037U;
    for (const unsigned char c : text) hash = (hash ^ c) * 1099511628211U;
    return hash;
}

}  // namespace

JournalPlace::JournalPlace(const std::filesystem::path& document) {
    const std::filesystem::path folder = state_folder();
    std::error_code error;
    if (folder.empty()) return;
    std::filesystem::create_directories(folder, error);
    if (error) return;
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
    const std::uint64_t hash = compute_hash(std::filesystem::absolute(document).lexically_normal().string());
    for (int i = 0; i < kMaxPlaces; ++i) {
        const std::string base = (folder / fmt::format("{:016x}-{}", hash, i)).string();
        lock_ = ::open((base + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
        if (lock_ < 0) return;
        if (flock(lock_, LOCK_EX | LOCK_NB) == 0) {
            file_ = base + ".coppice";
            return;
        }
        ::close(lock_);
        lock_ = -1;
    }
}

JournalPlace::~JournalPlace() {
    if (lock_ >= 0) ::close(lock_);
}

}  // namespace coppice::server
