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

/// What became of a program.
struct ProgramResult {
    std::string text;           ///< what it printed, up to 64 KiB
    std::optional<int> status;  ///< with which it ended; none: it goes on
};

/// Programs that the menu starts. Those with a window of their own go on, and outlive this.
class Programs {
  public:
    Programs();
    ~Programs();
    Programs(const Programs&) = delete;
    Programs& operator=(const Programs&) = delete;

    /// Starts a program in a folder, without input and with no more of the environment than programs need,
    /// and waits until it ends, or for so long: what it does then is its own affair. Throws InvalidInput
    /// where there is no such program, or 8 go on already; IoError where it cannot be started; Cancelled, and
    /// then it has been ended.
    ProgramResult run(std::vector<std::string> words, const std::filesystem::path& folder,
                      std::chrono::milliseconds patience, const Context& ctx);
    std::size_t going_on();  ///< number of programs that do

  private:
    /// Takes what a program prints until it ends, so that it need not wait.
    struct Reader;
    std::list<Reader> readers_;
};

}  // namespace coppice::studio_internal
