#pragma once

#include "coppice/base/id.h"

namespace coppice {

/// A branch that ends at a node of another branch, so that both form one body.
struct NodeJoin {
    NodeId end;   ///< its last node, at the position of ...
    NodeId node;  ///< ... this node
    friend bool operator==(const NodeJoin&, const NodeJoin&) = default;  ///< compares the nodes
};

}  // namespace coppice
