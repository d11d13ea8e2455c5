#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/system/descriptor.h"

namespace coppice {

/// Returns the path of a program given by name, such as ffmpeg, or by an absolute path; nullopt if it does
/// not exist. Searches the absolute folders of PATH.
std::optional<std::filesystem::path> find_program(std::string_view name);

/// Destination of the standard output and standard error of a program.
enum class ProgramOutput {
    inherited,  ///< those of this process
    discarded,  ///< none
    received    ///< Program::receive(); the program does not end when its output is no longer received
};

/// Options for starting a program.
struct ProgramStart {
    std::vector<std::string> words;  ///< absolute path of the program and its arguments
    bool sends_input = false;        ///< whether Program::send() writes its standard input, else empty
    ProgramOutput output = ProgramOutput::inherited;  ///< destination of its standard output
    std::filesystem::path folder = {};                ///< working folder; empty: that of this process
    std::vector<std::string> environment = {};        ///< entries NAME=VALUE; empty: those of this process
    bool apart = false;  ///< whether it runs in its own session, detached from the terminal of this process
};

/// A program that runs in parallel, started without a shell, blocked signals or inherited descriptors. It
/// runs on after the destruction of this object, which closes its streams.
class Program {
  public:
    /// Starts the program. Throws IoError with its name.
    explicit Program(const ProgramStart& start);

    /// Writes to its standard input; returns false if the program no longer reads it.
    bool send(std::string_view bytes);
    void close_input() { input_.close(); }  ///< ends its standard input

    /// Waits at most `wait` for output, and appends it to `text` up to `max_size` bytes; the rest is dropped.
    /// Returns false at the end of the output.
    bool receive(std::string& text, std::size_t max_size, std::chrono::milliseconds wait);

    /// Returns the exit code if the program has ended, or 128 plus the number of the signal that ended it.
    std::optional<int> status();
    int wait();   ///< waits until the program ends; returns the same
    void kill();  ///< ends the program, and its session if it runs apart

  private:
    Descriptor input_, output_;
    int process_ = -1;  ///< id of the process
    bool apart_ = false;
    std::optional<int> status_;
};

}  // namespace coppice
