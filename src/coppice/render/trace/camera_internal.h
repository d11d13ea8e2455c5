#pragma once

#include <optional>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/render/frame_view.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// A point with a surrounding ball that must fit into the image.
struct FramePoint {
    Vec3 position;
    float radius = 0;
};

/// A camera, perspective or that of a view. Pixel (0, 0) is in the upper left corner of the image.
class Camera {
  public:
    /// Looks in the direction of the options from the distance at which all points fit; then it moves
    /// perpendicular to its direction until `middle`, if given, is at the centre of the image, and zooms.
    /// O(n).
    Camera(std::span<const FramePoint> points, const CameraOptions& options, float zoom = 1,
           std::optional<Vec3> middle = std::nullopt);
    /// The camera of a view in the coordinates of the scene.
    explicit Camera(const SketchView& view);

    Vec3 position() const { return position_; }  ///< for an orthographic one, a point behind the image plane
    struct Ray {
        Vec3 origin;
        Vec3 direction;  ///< unit
    };
    Ray ray(float x, float y) const;       ///< through a point of the image
    Vec3 right() const { return right_; }  ///< unit, to the right in the image
    Vec3 to_camera() const { return -forward_; }

    struct Projected {
        float x, y;   ///< [pixels]
        float depth;  ///< along the view; <= 0 is behind the camera
    };
    Projected project(Vec3 p) const;

  private:
    Vec3 position_, right_, up_, forward_;
    float width_ = 0, height_ = 0;
    float tan_x_ = 0, tan_y_ = 0;     ///< half openings
    std::optional<SketchView> view_;  ///< replaces all of the above except the first line
};

}  // namespace coppice
