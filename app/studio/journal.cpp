#include "journal.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <system_error>

#include "coppice/base/error.h"

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
    try {
        for (int i = 0; i < kMaxPlaces && !lock_; ++i) {
            const std::string base = (folder / fmt::format("{:016x}-{}", hash, i)).string();
            lock_ = FileLock::try_lock(base + ".lock");
            if (lock_) file_ = base + ".coppice";
        }
    } catch (const IoError&) {
        return;  // without a journal
    }
}

}  // namespace coppice::server
