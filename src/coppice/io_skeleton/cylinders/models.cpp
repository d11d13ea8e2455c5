#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/cylinders/models_internal.h"

namespace coppice {

std::size_t chosen_model(std::size_t count, int model, const std::string& source) {
    if (model == 0 && count > 1) {
        throw InvalidInput(fmt::format("{}: it contains {} models; choose one with the option model, 1 to {}",
                                       source, count, count));
    }
    if (model < 0 || static_cast<std::size_t>(model) > count)
        throw InvalidInput(
            fmt::format("{}: there is no model {}; the file contains {}", source, model, count));
    return model == 0 ? 0 : static_cast<std::size_t>(model) - 1;
}

}  // namespace coppice
