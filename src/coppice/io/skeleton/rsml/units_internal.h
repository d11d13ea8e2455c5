#pragma once

#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/io/skeleton/rsml/document_internal.h"

namespace coppice::rsml {

/// Metres that a pixel stands for. Where the file tells none it is 1, and a note says so.
///
/// A resolution of a file in metres, centimetres, millimetres or inches is the number of pixels in the unit,
/// or where it is less than 1 the length of a pixel; micrometres and nanometres always are the length of one.
double metres_per_pixel(const Document& document, std::vector<std::string>& notes);

/// Turns what a file calls up to Z.
///
/// In images y runs down: drawings stand upright in the plane of X and Z. They do so also where y runs up,
/// and points in space where the first roots of the plants run along y rather than along z; that side
/// of y is down to which the first roots run. Other points in space keep their axes, and so do all files of
/// Coppice.
class Upright {
  public:
    Upright(const Document& document, std::vector<std::string>& notes);

    Vec3d operator()(Vec3d p) const { return down_ == 0 ? p : Vec3d{p.x, down_ * p.z, -down_ * p.y}; }

  private:
    double down_ = 0;  // the side of y that is down; 0 = z is up
};

}  // namespace coppice::rsml
