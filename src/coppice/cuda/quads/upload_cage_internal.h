#pragma once

#include "coppice/subdivision/kernel/cage_view.h"

namespace coppice::cuda {

/// Copies the topology of a cage to an executor.
template <class Exec>
CageView upload_cage(Exec& exec, const CageView& cage) {
    CageView out;
    out.quads = exec.upload(cage.quads);
    out.side = exec.upload(cage.side);
    out.edge_half = exec.upload(cage.edge_half);
    out.fan_first = exec.upload(cage.fan_first);
    out.fan_half = exec.upload(cage.fan_half);
    out.on_boundary = exec.upload(cage.on_boundary);
    return out;
}

}  // namespace coppice::cuda
