#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// Returns the path of a program given by name, such as ffmpeg, or by an absolute path; nullopt if it does
/// not exist. Searches the absolute folders of PATH.
std::optional<std::filesystem::path> find_program(std::string_view name);

/// Options for starting a program.
struct ProgramStart {
    std::vector<std::string> words;  ///< absolute path of the program and its arguments
    int input = -1;                  ///< descriptor of standard input; -1: empty
    int output = -1;  ///< descriptor of standard output and standard error; -1: those of this process
    std::filesystem::path folder = {};          ///< working folder; empty: that of this process
    std::vector<std::string> environment = {};  ///< entries NAME=VALUE; empty: those of this process
    bool apart = false;  ///< whether it runs in its own session, detached from the terminal of this process
};

/// Starts a program in parallel, without a shell, blocked signals or inherited descriptors. Throws IoError
/// with its name.
pid_t start_program(const ProgramStart& start);

/// Waits until a program ends and returns its status as waitpid does.
int wait_for_program(pid_t program);
/// Returns the status if the program has ended, without waiting.
std::optional<int> ended_program(pid_t program);

}  // namespace coppice
