#include "streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "coppice/base/error.h"
#include "coppice/system/file.h"

namespace coppice::cli {
namespace {

[[noreturn]] void fail_output() {
    throw IoError(fmt::format("cannot write to the standard output: {}", file_error_text(errno)));
}

}  // namespace

void open_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The stream receives the lowest free descriptor. The mode is chosen so that using the stream fails.
        static_cast<void>(::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
    }
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_output();
}

void flush_output() {
    if (std::fflush(stdout) != 0) fail_output();
}

void print_error(std::string_view text) noexcept {
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

}  // namespace coppice::cli
