#pragma once

#include <optional>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/render/render.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// A point with a ball about it that has to fit into the picture.
struct FramePoint {
    Vec3 position;
    float radius = 0;
};

/// A camera, perspective or that of a view. Pixel (0, 0) is the upper left corner of the picture.
class Camera {
  public:
    /// Looks in the direction of the options and steps back until all points fit; then it moves across its
    /// direction until `middle`, if there is one, stands in the middle of the picture, and zooms. O(n).
    Camera(std::span<const FramePoint> points, const RenderOptions& options,
           std::optional<Vec3> middle = std::nullopt);
    /// That of a view, which is given in the coordinates of the scene.
    explicit Camera(const SketchView& view);

    Vec3 position() const { return position_; }  ///< of an orthographic one, some place behind the picture
    struct Ray {
        Vec3 origin;
        Vec3 direction;  ///< unit
    };
    Ray ray(float x, float y) const;       ///< through a point of the picture
    Vec3 right() const { return right_; }  ///< unit, to the right in the picture
    Vec3 to_camera() const { return -forward_; }

    struct Projected {
        float x, y;   ///< [pixels]
        float depth;  ///< along the view; <= 0 lies behind the camera
    };
    Projected project(Vec3 p) const;

  private:
    Vec3 position_, right_, up_, forward_;
    float width_ = 0, height_ = 0;
    float tan_x_ = 0, tan_y_ = 0;     ///< half openings
    std::optional<SketchView> view_;  ///< takes the place of all but the first line
};

}  // namespace coppice
