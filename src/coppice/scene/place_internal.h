#pragma once

#include <fmt/format.h>

#include <new>
#include <string>
#include <string_view>

#include "coppice/base/error.h"

namespace coppice::scene_internal {

/// Returns the message with the place as prefix. Some messages of the library begin with the name of the
/// stage, which may be the name of the command.
inline std::string with_place(const std::string& place, std::string_view message) {
    const std::size_t space = place.rfind(' ');
    const std::string last = place.substr(space == place.npos ? 0 : space + 1) + ":";
    if (message.starts_with(last + " ")) message.remove_prefix(last.size() + 1);
    return place.empty() ? std::string(message) : fmt::format("{}: {}", place, message);
}

/// Calls work, and adds the place as prefix to the message of an exception.
template <class Work>
auto placed(const std::string& place, const Work& work) {
    try {
        return work();
    } catch (const Cancelled&) {
        throw;
    } catch (const IoError& error) {
        throw IoError(with_place(place, error.what()));
    } catch (const Unsupported& error) {
        throw Unsupported(with_place(place, error.what()));
    } catch (const Error& error) {
        throw InvalidInput(with_place(place, error.what()));
    } catch (const std::bad_alloc&) {
        throw InvalidInput(with_place(place, "there is not enough memory for this command"));
    }
}

}  // namespace coppice::scene_internal
