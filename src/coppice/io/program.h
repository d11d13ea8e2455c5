#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// Where a program lies that is called by a name, as ffmpeg, or by an absolute path; none where there is no
/// such one. Looks through the absolute folders of PATH.
std::optional<std::filesystem::path> find_program(std::string_view name);

/// How a program is started.
struct ProgramStart {
    std::vector<std::string> words;  ///< the program, absolute, and its arguments
    int input = -1;                  ///< what it reads; -1: nothing
    int output = -1;                 ///< where its output and its errors go; -1: where those of this one go
    std::filesystem::path folder = {};          ///< that it works in; empty: the one of this program
    std::vector<std::string> environment = {};  ///< NAME=VALUE; empty: that of this program
    bool apart = false;  ///< in a session of its own, without what a terminal says to this one
};

/// Starts a program beside this one: no shell, no signals blocked, no other files open. Throws IoError naming
/// it.
pid_t start_program(const ProgramStart& start);

/// Waits for a program to end; returns its status as waitpid gives it.
int wait_for_program(pid_t program);
/// The same where it has ended already.
std::optional<int> ended_program(pid_t program);

}  // namespace coppice
