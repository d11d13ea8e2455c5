#pragma once

#include <span>

#include "coppice/base/vec.h"
#include "coppice/render/render.h"

namespace coppice {

/// A point with a ball about it that has to fit into the picture.
struct FramePoint {
    Vec3 position;
    float radius = 0;
};

/// A perspective camera. Pixel (0, 0) is the upper left corner of the picture.
class Camera {
  public:
    /// Looks in the direction of the options and steps back until all points fit. O(n).
    Camera(std::span<const FramePoint> points, const RenderOptions& options);

    Vec3 position() const { return position_; }
    Vec3 direction(float x, float y) const;  ///< unit, through a point of the picture
    Vec3 right() const { return right_; }    ///< unit, to the right in the picture
    Vec3 to_camera() const { return -forward_; }

    struct Projected {
        float x, y;   ///< [pixels]
        float depth;  ///< along the view; <= 0 lies behind the camera
    };
    Projected project(Vec3 p) const;

  private:
    Vec3 position_, right_, up_, forward_;
    float width_, height_;
    float tan_x_, tan_y_;  ///< half openings
};

}  // namespace coppice
