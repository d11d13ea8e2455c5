#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/points/point_set.h"

namespace coppice::io_internal {

/// Whether a coordinate is finite and not beyond 1e30, where floats end.
bool fits_points(Vec3d p);

/// Chooses the origin and rounds. Throws `InvalidInput` when there is no point.
PointSet to_point_set(const std::vector<Vec3d>& points, const std::string& source);

bool is_las(std::string_view bytes);  ///< starts with the signature "LASF"; LAZ does too
bool is_pcd(std::string_view bytes);  ///< starts with the comment or the version line of PCD

/// LAS 1.0 to 1.4, all point formats from 0 to 10; points marked as withheld are passed over. LAZ too.
PointSet parse_las(std::string_view bytes, const std::string& source, const Context& ctx);

/// PCD 0.5 to 0.7, data ascii, binary and binary_compressed; points without numbers (NaN) are passed over.
PointSet parse_pcd(std::string_view bytes, const std::string& source, const Context& ctx);

/// Text, see `read_points`.
std::vector<Vec3d> parse_xyz(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
