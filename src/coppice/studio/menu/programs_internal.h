#pragma once

#include <chrono>
#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coppice/base/context.h"

namespace coppice::studio_internal {

/// The result of starting a program.
struct ProgramResult {
    std::string text;           ///< its output, at most 64 KiB
    std::optional<int> status;  ///< its exit code; nullopt: it is still running
};

/// Programs started by the menu. Those with a window keep running, also after the destruction of this object.
class Programs {
  public:
    Programs();
    ~Programs();
    Programs(const Programs&) = delete;
    Programs& operator=(const Programs&) = delete;

    /// Starts a program in a folder, without input and with only the required environment variables, and
    /// waits until it ends or the time limit passes; it may run on afterwards. Throws InvalidInput if there
    /// is no such program, or 8 are running; IoError if it cannot be started; Cancelled after ending it.
    ProgramResult run(std::vector<std::string> words, const std::filesystem::path& folder,
                      std::chrono::milliseconds patience, const Context& ctx);
    std::size_t going_on();  ///< number of running programs

  private:
    /// Reads the output of a program until it ends, so that the program never blocks.
    struct Reader;
    std::list<Reader> readers_;
};

}  // namespace coppice::studio_internal
