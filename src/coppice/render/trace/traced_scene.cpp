#include "coppice/render/trace/traced_scene_internal.h"

#include <algorithm>
#include <array>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr double kMaxSize = 1e15;  // [m] beyond it squares of floats overflow
constexpr std::size_t kGrain = 65536;
constexpr std::size_t kMaxPoints = 4'000'000;  // maximum number of drawn points
constexpr float kMinRadius = 1e-6f;            // of balls, relative to the diagonal

struct Box3d {
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void extend(Vec3d p, double radius) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k] - radius);
            high[k] = std::max(high[k], p[k] + radius);
        }
    }
};

struct Ball {
    Vec3 center;
    float radius;
};
static_assert(sizeof(Ball) == 16);

/// Segments as cones; degenerate cones (zero length, one end inside the other, a single node) as balls.
struct Tubes {
    std::vector<Ball> cones;  ///< two per cone
    std::vector<Ball> balls;
    std::vector<std::uint32_t> cone_nodes, ball_nodes;  ///< their nodes

    void add(Ball a, Ball b, NodeId node) {
        if (distance(a.center, b.center) <= std::abs(a.radius - b.radius) * 1.0001f + 1e-9f) {
            add(a.radius > b.radius ? a : b, node);
        } else {
            cones.push_back(a);
            cones.push_back(b);
            cone_nodes.push_back(node.index());
        }
    }
    void add(Ball ball, NodeId node) {
        balls.push_back(ball);
        ball_nodes.push_back(node.index());
    }
};

void attach(RTCScene scene, RTCDevice device, RTCGeometryType type, const std::vector<Ball>& balls) {
    if (balls.empty()) return;
    const EmbreeGeometry geometry(rtcNewGeometry(device, type));
    std::ranges::copy(balls, new_embree_buffer<Ball>(geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                     RTC_FORMAT_FLOAT4, balls.size())
                                 .begin());
    if (type == RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE) {
        const auto first = new_embree_buffer<std::uint32_t>(geometry.get(), RTC_BUFFER_TYPE_INDEX,
                                                            RTC_FORMAT_UINT, balls.size() / 2);
        for (std::size_t i = 0; i < first.size(); ++i) first[i] = static_cast<std::uint32_t>(2 * i);
    }
    attach_geometry(scene, geometry.get());
}

/// Adds the values of the corners of a face, divided in the same way as by `add_faces`.
template <class T>
void add_corners(std::span<const T> t, std::vector<std::array<T, 4>>& out) {
    if (t.size() == 4) out.push_back({t[0], t[1], t[2], t[3]});
    for (std::size_t k = 1; t.size() != 4 && k + 1 < t.size(); ++k)
        out.push_back({t[0], t[k], t[k + 1], t[k + 1]});
}

}  // namespace

TracedScene::TracedScene(const RenderScene& scene, const RenderOptions& options, const Context& ctx)
    : deviation_(scene.deviation),
      evidence_(scene.evidence),
      distance_to_(scene.distance_to),
      node_colors_(scene.skeleton_colors) {
    for (const Rgb color : scene.mesh_colors) vertex_colors_.push_back(to_linear(color));
    const bool inside = scene.mesh != nullptr || scene.cloud != nullptr;
    const float skeleton_width = inside ? options.axis_width : 1;
    if (scene.cloud != nullptr) {
        cloud_size_ = scene.cloud->points.size();
        point_count_ = std::min(cloud_size_, kMaxPoints);
        point_colors_ = scene.cloud->colors;
    }
    place(scene, skeleton_width);
    device_ = new_embree_device(ctx);
    if (inside) {
        solid_.reset(rtcNewScene(device_.get()));
        if (scene.mesh != nullptr) {
            add_faces(*scene.mesh, scene.marked_faces);
            if (!options.flat) smooth_normals();
            if (scene.material != nullptr || !scene.materials.empty()) add_texture(scene);
            attach_mesh(solid_.get(), quads_, ctx);
            kinds_.push_back(GeometryKind::mesh);
        }
        if (point_count_ > 0) {
            attach_points(solid_.get(), scene);
            kinds_.push_back(GeometryKind::points);
        }
        commit_scene(device_.get(), solid_.get(), ctx);
        if (!marked_quads_.empty()) {
            marked_.reset(rtcNewScene(device_.get()));
            attach_mesh(marked_.get(), marked_quads_, ctx);
            commit_scene(device_.get(), marked_.get(), ctx);
        }
        if (scene.skeleton != nullptr) axis_ = build_tubes(*scene.skeleton, skeleton_width, ctx);
    } else {
        solid_ = build_tubes(*scene.skeleton, skeleton_width, ctx);
        kinds_ = {GeometryKind::tubes, GeometryKind::tubes};  // cones and balls
    }
    collect_frame_points(scene, skeleton_width);
}

/// Includes the axis inside a mesh with its drawn width, so that the ground touches the mesh.
void TracedScene::place(const RenderScene& scene, float skeleton_width) {
    Box3d box;
    if (scene.mesh != nullptr) {
        for (const std::uint32_t v : scene.mesh->corners) {
            box.extend(Vec3d(scene.mesh->positions[v]) + scene.mesh->origin, 0);
        }
    }
    for (std::size_t k = 0; k < point_count_; ++k)
        box.extend(scene.cloud->points.world(drawn_point(k)), double{scene.point_radius});
    if (scene.skeleton != nullptr) {
        for (const NodeId n : nodes(*scene.skeleton)) {
            box.extend(Vec3d(scene.skeleton->position(n)) + scene.skeleton->origin(),
                       skeleton_width * scene.skeleton->radius(n));
        }
    }
    if (!scene.framed.empty()) {
        box = {};
        for (const Vec3d& p : scene.framed) box.extend(p, 0);
    }
    const double size = distance(box.low, box.high);
    if (!(size < kMaxSize))
        throw InvalidInput("render: the object is larger than 1e15 m; check its coordinates");
    center_ = 0.5 * (box.low + box.high);
    scale_ = size > 0 ? 1 / size : 1;
    const Vec3d half = 0.5 * scale_ * (box.high - box.low);
    bounds_.extend(Vec3(half));
    bounds_.extend(-Vec3(half));
}

void TracedScene::add_faces(const PolygonMesh& mesh, std::span<const std::uint32_t> marked) {
    std::vector<std::uint8_t> is_marked(mesh.face_count(), 0);
    for (const std::uint32_t f : marked) is_marked[f] = 1;
    positions_.reserve(mesh.positions.size());
    for (const Vec3 p : mesh.positions) positions_.push_back(local(p, mesh.origin));
    quads_.reserve(mesh.face_count());
    edges_.reserve(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto c = mesh.face(f);
        const std::size_t begin = quads_.size();
        if (c.size() == 4) {
            quads_.push_back({c[0], c[1], c[2], c[3]});
            edges_.push_back(0b1111);
        }
        for (std::size_t k = 1; c.size() != 4 && k + 1 < c.size(); ++k) {
            quads_.push_back({c[0], c[k], c[k + 1], c[k + 1]});
            edges_.push_back(
                static_cast<std::uint8_t>((k == 1 ? 1 : 0) | 0b10 | (k + 2 == c.size() ? 0b1000 : 0)));
        }
        if (is_marked[f] != 0)
            marked_quads_.insert(marked_quads_.end(), quads_.begin() + static_cast<std::ptrdiff_t>(begin),
                                 quads_.end());
    }
}

void TracedScene::add_texture(const RenderScene& scene) {
    const PolygonMesh& mesh = *scene.mesh;
    texture_.reserve(quads_.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::size_t first = mesh.first[f], count = mesh.first[f + 1] - first;
        add_corners(std::span(mesh.texture).subspan(first, count), texture_);
        if (!mesh.texture_blends.empty())
            add_corners(std::span(mesh.texture_blends).subspan(first, count), texture_blends_);
        if (!scene.face_materials.empty()) quad_materials_.resize(texture_.size(), scene.face_materials[f]);
    }
}

/// Returns the mean of the normals of the adjacent faces for each vertex, weighted by area.
void TracedScene::smooth_normals() {
    normals_.assign(positions_.size(), Vec3{});
    for (const Quad& q : quads_) {
        const Vec3 n = cross(positions_[q[2]] - positions_[q[0]], positions_[q[3]] - positions_[q[1]]);
        for (std::size_t k = 0; k < (q[2] == q[3] ? 3u : 4u); ++k) normals_[q[k]] += n;
    }
    for (Vec3& n : normals_) n = normalized(n, Vec3{});
}

void TracedScene::collect_frame_points(const RenderScene& scene, float skeleton_width) {
    if (!scene.framed.empty()) {
        for (const Vec3d& p : scene.framed) frame_points_.push_back({local(p)});
        return;
    }
    if (scene.mesh != nullptr) {
        std::vector<bool> used(positions_.size());
        for (const std::uint32_t v : scene.mesh->corners) used[v] = true;
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (used[v]) frame_points_.push_back({positions_[v]});
        }
    }
    for (std::size_t k = 0; k < point_count_; ++k) {
        frame_points_.push_back(
            {local(scene.cloud->points.world(drawn_point(k))), local_length(scene.point_radius)});
    }
    if (scene.skeleton == nullptr) return;
    const Skeleton& s = *scene.skeleton;
    for (const NodeId n : nodes(s)) {
        frame_points_.push_back(
            {local(s.position(n), s.origin()), static_cast<float>(skeleton_width * s.radius(n) * scale_)});
    }
}

void TracedScene::attach_mesh(RTCScene scene, std::span<const Quad> of, const Context& ctx) {
    const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_QUAD));
    const auto positions =
        new_embree_buffer<Vec3>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, positions_.size());
    const auto quads =
        new_embree_buffer<Quad>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, of.size());
    parallel_for(ctx, positions.size(), kGrain, [&](std::size_t i) { positions[i] = positions_[i]; });
    parallel_for(ctx, quads.size(), kGrain, [&](std::size_t i) { quads[i] = of[i]; });
    attach_geometry(scene, geometry.get());
}

void TracedScene::attach_points(RTCScene scene, const RenderScene& of) {
    std::vector<Ball> balls;
    balls.reserve(point_count_);
    const float radius = std::max(kMinRadius, local_length(of.point_radius));
    for (std::size_t k = 0; k < point_count_; ++k)
        balls.push_back({local(of.cloud->points.world(drawn_point(k))), radius});
    attach(scene, device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT, balls);
}

EmbreeScene TracedScene::build_tubes(const Skeleton& s, float width, const Context& ctx) {
    const auto ball = [&](Vec3 p, float radius) {
        return Ball{local(p, s.origin()), std::max(kMinRadius, static_cast<float>(width * radius * scale_))};
    };
    Tubes tubes;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            const Segment g = s.segment(n);
            tubes.add(ball(g.a, g.radius_a), ball(g.b, g.radius_b), n);
        } else if (s.is_tip(n)) {
            tubes.add(ball(s.position(n), s.radius(n)), n);
        }
    }
    EmbreeScene scene(rtcNewScene(device_.get()));
    attach(scene.get(), device_.get(), RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, tubes.cones);
    attach(scene.get(), device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT, tubes.balls);
    commit_scene(device_.get(), scene.get(), ctx);
    // Geometries without elements are not attached.
    for (auto* part_nodes : {&tubes.cone_nodes, &tubes.ball_nodes})
        if (!part_nodes->empty()) tube_nodes_.push_back(std::move(*part_nodes));
    return scene;
}

/// Returns the weights of three corners at a hit, which sum to 1. Bilinear faces are two triangles with the
/// diagonal from corner 1 to corner 3.
struct Weights3 {
    std::array<std::size_t, 3> corner;
    std::array<std::uint32_t, 3> vertex;
    std::array<float, 3> weight;
};

Weights3 weights_at(const Quad& q, float u, float v) {
    if (u + v <= 1) return {{0, 1, 3}, {q[0], q[1], q[3]}, {1 - u - v, u, v}};
    return {{2, 3, 1}, {q[2], q[3], q[1]}, {u + v - 1, 1 - u, 1 - v}};
}

template <class T>
T TracedScene::blend(const Hit& hit, std::span<const T> of) const {
    const auto [corner, vertex, weight] = weights_at(quads_[hit.face], hit.u, hit.v);
    return of[vertex[0]] * weight[0] + of[vertex[1]] * weight[1] + of[vertex[2]] * weight[2];
}

/// Returns the weighted mean of the projections onto the tangent planes of the corners, for planes above the
/// face [Hanika2021]. `side` is -1 if the mesh is seen from inside.
Vec3 TracedScene::lifted(const Hit& hit, float side) const {
    const auto [corner, vertex, weight] = weights_at(quads_[hit.face], hit.u, hit.v);
    Vec3 p = hit.position;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 normal = normals_[vertex[k]] * side;
        p += normal * (weight[k] * std::max(0.0f, dot(positions_[vertex[k]] - hit.position, normal)));
    }
    return p;
}

std::optional<Hit> TracedScene::trace(Vec3 origin, Vec3 direction) const {
    return trace(solid_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace_axis(Vec3 origin, Vec3 direction) const {
    return trace(axis_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace_marked(Vec3 origin, Vec3 direction) const {
    return trace(marked_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace(RTCScene scene, Vec3 origin, Vec3 direction) const {
    const RTCRayHit r = cast_ray(scene, origin, direction);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    Hit hit;
    hit.distance = r.ray.tfar;
    hit.position = origin + direction * hit.distance;
    hit.geometric_normal = normalized(Vec3{r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z}, -direction);
    const bool is_solid = scene == solid_.get();
    hit.on_mesh = is_solid && kinds_[r.hit.geomID] == GeometryKind::mesh;
    if (is_solid && kinds_[r.hit.geomID] == GeometryKind::points) hit.point = r.hit.primID;
    if (scene == axis_.get() || (is_solid && kinds_[r.hit.geomID] == GeometryKind::tubes))
        hit.node = tube_nodes_[r.hit.geomID][r.hit.primID];
    hit.face = r.hit.primID;
    hit.u = r.hit.u, hit.v = r.hit.v;
    if (dot(hit.geometric_normal, direction) > 0) hit.geometric_normal = -hit.geometric_normal;
    hit.normal = hit.geometric_normal;
    hit.lifted = hit.position;
    if (hit.on_mesh && !normals_.empty()) {
        const Vec3 n = blend(hit, std::span<const Vec3>(normals_));
        const Vec3 smooth = normalized(n, hit.geometric_normal);
        const float side = dot(smooth, hit.geometric_normal) < 0 ? -1.0f : 1.0f;
        hit.normal = smooth * side;
        hit.lifted = lifted(hit, side);
    }
    return hit;
}

bool TracedScene::occluded(Vec3 origin, Vec3 direction, float far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r{};
    r.org_x = origin.x, r.org_y = origin.y, r.org_z = origin.z;
    r.dir_x = direction.x, r.dir_y = direction.y, r.dir_z = direction.z;
    r.tfar = far;
    r.mask = ~0u;
    rtcOccluded1(solid_.get(), &context, &r);
    return r.tfar < 0;
}

float TracedScene::deviation(const Hit& hit) const { return blend(hit, deviation_); }

std::optional<Vec3> TracedScene::object_color(const Hit& hit) const {
    if (hit.on_mesh && !vertex_colors_.empty()) return blend(hit, std::span<const Vec3>(vertex_colors_));
    if (hit.node && !node_colors_.empty()) return to_linear(node_colors_[*hit.node]);
    return std::nullopt;
}

std::optional<TexturePlaces> TracedScene::texture_places(const Hit& hit) const {
    if (texture_.empty() || !hit.on_mesh) return std::nullopt;
    TexturePlaces out{texture_place(hit, texture_[hit.face]),
                      {},
                      0,
                      quad_materials_.empty() ? 0 : quad_materials_[hit.face]};
    if (texture_blends_.empty()) return out;
    const auto& blends = texture_blends_[hit.face];
    const auto [corner, vertex, weight] = weights_at(quads_[hit.face], hit.u, hit.v);
    for (std::size_t k = 0; k < 3; ++k) out.weight += blends[corner[k]].weight * weight[k];
    if (!(out.weight > 0)) return out;
    out.second = texture_place(hit, {blends[0].second, blends[1].second, blends[2].second, blends[3].second});
    return out;
}

TexturePlace TracedScene::texture_place(const Hit& hit, const std::array<TexturePoint, 4>& t) const {
    const auto [corner, vertex, weight] = weights_at(quads_[hit.face], hit.u, hit.v);
    const TexturePoint a = t[corner[0]], b = t[corner[1]], c = t[corner[2]];
    TexturePlace out{a.u * weight[0] + b.u * weight[1] + c.u * weight[2],
                     a.v * weight[0] + b.v * weight[1] + c.v * weight[2],
                     {},
                     {}};
    const Vec3 to_b = positions_[vertex[1]] - positions_[vertex[0]];
    const Vec3 to_c = positions_[vertex[2]] - positions_[vertex[0]];
    const Vec3 across = cross(to_b, to_c);
    const float square = dot(across, across);
    if (!(square > 0)) return out;
    // Gradients of the weights of b and c.
    const Vec3 of_b = cross(to_c, across) / square, of_c = cross(across, to_b) / square;
    out.gradient_u = of_b * (b.u - a.u) + of_c * (c.u - a.u);
    out.gradient_v = of_b * (b.v - a.v) + of_c * (c.v - a.v);
    return out;
}

double TracedScene::distance_to_other(const Hit& hit) const {
    // More accurate than hit.position, which is rounded in proportion to the distance of the camera.
    const Vec3d p(blend(hit, std::span<const Vec3>(positions_)));
    return distance_to_->signed_distance(p / scale_ + (center_ - distance_to_->mesh().origin));
}

SketchView TracedScene::local(SketchView view) const {
    // scale (R X + t) = R (scale (X - center)) + scale (R center + t), and the image of a perspective camera
    // does not depend on the scale.
    view.t = (view.r * center_ + view.t) * scale_;
    if (view.projection == Projection::orthographic)
        for (const std::size_t row : {std::size_t{0}, std::size_t{1}})
            for (const std::size_t column : {std::size_t{0}, std::size_t{1}}) view.k[row][column] /= scale_;
    return view;
}

}  // namespace coppice
