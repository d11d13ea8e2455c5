#include "coppice/cuda/quads/device_quads.h"

#include <algorithm>
#include <optional>

#include "coppice/cuda/field/upload_field.h"
#include "coppice/cuda/lists/lists_stages.h"
#include "coppice/cuda/quads/project_field.cuh"

namespace coppice {

namespace cuda {

void project(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel, const FieldArrays& field) {
    with_formula(kernel, [&](const auto& formula) { stages.project(FieldView(formula, field)); });
}

UntangleReport untangle(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel,
                        const FieldArrays& field) {
    UntangleReport report;
    with_formula(kernel, [&](const auto& formula) { report = stages.untangle(FieldView(formula, field)); });
    return report;
}

}  // namespace cuda

struct DeviceQuads::Impl {
    // What the lists of a field are made of, where the card makes them.
    struct Contacts {
        cuda::ContactTables tables;
        cuda::ContactGeometry geometry;
        std::span<const std::uint32_t> order;
        cuda::ListRoom room;
    };

    cuda::CudaExecutor exec;
    std::optional<cuda::QuadStages<cuda::CudaExecutor>> stages;
    std::optional<Contacts> contacts;
    cuda::FieldArrays field;
    KernelConstants kernel;

    explicit Impl(const Context& ctx) : exec(ctx) {}

    void clear() {
        stages.reset();
        contacts.reset();
        exec.reset();
    }

    // False when the lists have to be made elsewhere.
    bool find_lists(const cuda::ContactInput& input) {
        const cuda::ContactTables tables = cuda::upload_contacts(exec, cuda::contact_topology(input));
        const cuda::ContactGeometry geometry = cuda::upload_geometry(exec, input);
        contacts = {tables, geometry, cuda::rival_order(exec, tables, geometry),
                    cuda::usual_room(tables.tubes.size())};
        const cuda::ContactsFound found =
            cuda::find_contacts(exec, tables, geometry, contacts->order, contacts->room);
        contacts->room = {std::max(contacts->room.own, found.state.entries.own),
                          std::max(contacts->room.rivals, found.state.entries.rivals)};
        field = {geometry.segments, found.lists.own, found.lists.rivals, input.field.blend(),
                 input.field.contact()};
        return !found.state.is_cut;
    }

    void run() {
        stages->refine();
        cuda::project(*stages, kernel, field);
    }
};

DeviceQuads::DeviceQuads(const Context& ctx) {
    require_device();
    impl_ = std::make_unique<Impl>(ctx);
}
DeviceQuads::~DeviceQuads() = default;
DeviceQuads::DeviceQuads(DeviceQuads&&) noexcept = default;
DeviceQuads& DeviceQuads::operator=(DeviceQuads&&) noexcept = default;

void DeviceQuads::begin(const cuda::QuadJob& job, const ConvolutionField& field) {
    impl_->clear();
    const std::uint64_t entries = field.own_lists().segments.size() + field.rival_lists().segments.size();
    impl_->exec.reserve(bytes_of(job, field.segments().size(), entries));
    impl_->kernel = field.kernel();
    impl_->field = cuda::upload_field(impl_->exec, field);
    impl_->stages.emplace(impl_->exec, job);
    impl_->run();
}

bool DeviceQuads::begin(const cuda::QuadJob& job, const cuda::ContactInput& contacts) {
    constexpr std::uint64_t kEntriesPerRegion = 100;  // with what finding them takes
    impl_->clear();
    const std::uint64_t entries = kEntriesPerRegion * contacts.control.region_node.size();
    impl_->exec.reserve(bytes_of(job, 4 * contacts.field.segments().size(), entries));
    impl_->kernel = contacts.field.kernel();
    if (!impl_->find_lists(contacts)) return false;
    impl_->stages.emplace(impl_->exec, job);
    impl_->run();
    return true;
}

cuda::QuadReport DeviceQuads::finish(Buffer<Vec3>& positions, Buffer<Vec3>* anchors) {
    auto& stages = *impl_->stages;
    cuda::QuadReport report;
    report.projected = stages.projected();
    report.untangled = cuda::untangle(stages, impl_->kernel, impl_->field);
    positions.resize(stages.counts().vertices);
    impl_->exec.download(stages.positions(), std::span(positions));
    if (anchors != nullptr) {
        anchors->resize(stages.counts().vertices);
        impl_->exec.download(stages.anchors(), std::span(*anchors));
    }
    return report;
}

void DeviceQuads::repeat() {
    auto& stages = *impl_->stages;
    stages.make_room();
    const auto before = impl_->exec.mark();
    if (const auto& c = impl_->contacts) {
        const cuda::DeviceLists lists =
            cuda::begin_contacts(impl_->exec, c->tables, c->geometry, c->order, c->room);
        impl_->field.own = lists.own;
        impl_->field.rivals = lists.rivals;
    }
    impl_->run();
    cuda::untangle(stages, impl_->kernel, impl_->field);
    stages.make_normals();
    stages.make_quads();
    impl_->exec.wait();
    impl_->exec.rewind(before);
}

void DeviceQuads::measure() { impl_->exec.measure(); }

std::vector<cuda::KernelTime> DeviceQuads::take_times() { return impl_->exec.take_times(); }

std::uint64_t DeviceQuads::bytes_used() const { return impl_->exec.bytes_used(); }

}  // namespace coppice
