#pragma once

#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/io_skeleton/rsml/document_internal.h"

namespace coppice::rsml {

/// Returns the length of a pixel in metres. If the file does not specify it, returns 1 and adds a note.
///
/// The resolution of a file in metres, centimetres, millimetres or inches is the number of pixels in the unit
/// or, if it is less than 1, the length of a pixel; in micrometres and nanometres it always is the length of
/// a pixel.
double metres_per_pixel(const Document& document, std::vector<std::string>& notes);

/// Rotates the up axis of a file to Z.
///
/// In images y points down: drawings are placed upright in the plane of X and Z. This also applies if y
/// points up, and to points in space if the first roots of the plants run along y rather than along z; the
/// direction of y in which the first roots run is down. Other points in space keep their axes, and so do all
/// files written by Coppice.
class Upright {
  public:
    Upright(const Document& document, std::vector<std::string>& notes);

    Vec3d operator()(Vec3d p) const { return down_ == 0 ? p : Vec3d{p.x, down_ * p.z, -down_ * p.y}; }

  private:
    double down_ = 0;  // sign of y that points down; 0: z is up
};

}  // namespace coppice::rsml
