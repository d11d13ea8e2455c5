#pragma once

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "command.h"
#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "memory.h"

namespace coppice::cli {

/// Returns work(). For an exception, calls fail(message) with a sentence and returns the exit code.
template <class Work, class Fail>
ExitCode catch_errors(const Work& work, const Fail& fail) {
    const auto failed = [&](ExitCode code, const char* message) {
        fail(message);
        return code;
    };
    try {
        return work();
    } catch (const UsageError& error) {
        return failed(kWrongUsage, error.what());
    } catch (const Cancelled& error) {
        return failed(kInterrupted, error.what());
    } catch (const IoError& error) {
        return failed(kFileTrouble, error.what());
    } catch (const Error& error) {
        return failed(kBadInput, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        return failed(kFileTrouble, fmt::format("cannot use {}: {}", error.path1().string(),
                                                file_error_text(error.code().value()))
                                        .c_str());
    } catch (const std::bad_alloc&) {
        return failed(kBadInput, out_of_memory_text());
    } catch (const std::exception& error) {
        return failed(kBadInput,
                      fmt::format("this is a defect of coppice, please report it: {}", error.what()).c_str());
    }
}

}  // namespace coppice::cli
