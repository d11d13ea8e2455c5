#pragma once

#include <bit>
#include <cstring>
#include <iterator>
#include <string>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "coppice/skeleton/skeleton.h"
#include "coppice/system/file_progress.h"

namespace coppice {

/// Builds the text of a skeleton, with numbers in world space.
class Encoder {
  public:
    Encoder(const Skeleton& skeleton, const Context& ctx)
        : skeleton_(skeleton), progress_({.stop = ctx.stop}, 0), is_local_(skeleton.origin() == Vec3d{}) {}

    template <class Format, class... Args>
    void add(const Format& format, const Args&... args) {
        progress_.at(text_.size());
        fmt::format_to(std::back_inserter(text_), format, args...);
    }

    /// Adds x, y and z of a node separated by `separator`.
    void add_position(NodeId n, char separator) {
        add_coordinate(n, 0);
        for (int axis = 1; axis < 3; ++axis) {
            text_.push_back(separator);
            add_coordinate(n, axis);
        }
    }

    /// Adds one coordinate of a node.
    void add_coordinate(NodeId n, int axis) {
        const float local = skeleton_.position(n)[axis];
        if (is_local_) {
            add(FMT_COMPILE("{}"), local);
        } else {
            add(FMT_COMPILE("{:.15g}"), skeleton_.origin()[axis] + local);
        }
    }

    template <class T>
    void add_bytes(T value) {
        static_assert(std::endian::native == std::endian::little, "binary PLY is written little-endian");
        progress_.at(text_.size());
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        text_.append(bytes, bytes + sizeof(T));
    }

    bool is_local() const { return is_local_; }
    std::string text() const { return {text_.data(), text_.size()}; }

  private:
    const Skeleton& skeleton_;
    FileProgress progress_;
    bool is_local_;
    fmt::memory_buffer text_;
};

}  // namespace coppice
