#pragma once

#include "coppice/base/id.h"

namespace coppice {

/// A branch that ends in a node of another branch, so that both are one body.
struct NodeJoin {
    NodeId end;                                                          ///< its last node, which lies at ...
    NodeId node;                                                         ///< ... this one
    friend bool operator==(const NodeJoin&, const NodeJoin&) = default;  ///< the same nodes
};

}  // namespace coppice
