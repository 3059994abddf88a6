// Intel Embree 3: one thread, the default build quality (medium) and the default scene flags (compact and robust off).
// Everything is in single precision. Embree finds the triangles near a point and calls measure() for each;
// closest_point() is the function of Embree's closest_point tutorial, after Ericson, Real-Time Collision Detection,
// 2005, section 5.1.5.
#include "bench/closest_rival.h"

#include "algorithms/error.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hausbench {
namespace {

struct Float3 {
    float x, y, z;
};
Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Float3 closest_point(Float3 p, Float3 a, Float3 b, Float3 c) {
    const Float3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Float3 bp = p - b;
    const float d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const Float3 cp = p - c;
    const float d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
    const float scale = 1 / (va + vb + vc);
    return a + (vb * scale) * ab + (vc * scale) * ac;
}

class Embree final : public ClosestRival {
public:
    Embree() : device_(rtcNewDevice("threads=1")) {
        if (device_ == nullptr) throw InputError("Embree: no device; is libembree3-3 whole?");
        rtcSetDeviceMemoryMonitorFunction(device_, &Embree::count_bytes, this);
    }
    ~Embree() override {
        forget();
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    std::string name() const override { return "Embree"; }

    void take(const TriangleMesh& mesh) override {
        vertices_.assign(static_cast<std::size_t>(mesh.vertices.rows()) + 1,
                         {});  // one more, because Embree reads 16 bytes for each vertex, also for the last
        for (Index i = 0; i < mesh.vertices.rows(); ++i) {
            const auto row = mesh.vertices.row(i).cast<float>();
            vertices_[static_cast<std::size_t>(i)] = {row[0], row[1], row[2]};
        }
        triangles_ = mesh.triangles;
    }

    void build() override {
        scene_ = rtcNewScene(device_);
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                                   sizeof(Float3), vertices_.size() - 1);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles_.data(), 0,
                                   3 * sizeof(Index), static_cast<std::size_t>(triangles_.rows()));
        rtcSetGeometryPointQueryFunction(geometry, &Embree::measure);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }

    void forget() override {
        if (scene_ != nullptr) rtcReleaseScene(scene_);
        scene_ = nullptr;
    }

    std::size_t bytes() const override { return bytes_ > 0 ? static_cast<std::size_t>(bytes_) : 0; }

    void distances(const Points& points, std::vector<double>& distances) override {
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        for (Index i = 0; i < points.rows(); ++i) {
            Query query{};
            const auto p = points.row(i).cast<float>();
            query.query.x = p[0];
            query.query.y = p[1];
            query.query.z = p[2];
            query.query.radius = std::numeric_limits<float>::infinity();
            query.embree = this;
            rtcPointQuery(scene_, &query.query, &context, nullptr, &query);
            distances[static_cast<std::size_t>(i)] = static_cast<double>(query.query.radius);
        }
    }

private:
    struct Query {
        RTCPointQuery query;
        const Embree* embree;
        unsigned triangle;
        Float3 point;
    };

    // Embree calls this for each triangle within the radius of a query. Lowers the radius to the triangle's distance.
    static bool measure(RTCPointQueryFunctionArguments* arguments) {
        Query& query = *static_cast<Query*>(arguments->userPtr);
        const auto row = query.embree->triangles_.row(static_cast<Index>(arguments->primID));
        const auto& vertices = query.embree->vertices_;
        const Float3 p{query.query.x, query.query.y, query.query.z};
        const Float3 q =
            closest_point(p, vertices[static_cast<std::size_t>(row[0])], vertices[static_cast<std::size_t>(row[1])],
                          vertices[static_cast<std::size_t>(row[2])]);
        const float distance = std::sqrt(dot(p - q, p - q));
        if (!(distance < arguments->query->radius)) return false;
        arguments->query->radius = distance;
        query.triangle = arguments->primID;
        query.point = q;
        return true;  // the radius has changed
    }

    // Embree calls this for each allocation, and with negative `bytes` when memory is freed.
    static bool count_bytes(void* self, ssize_t bytes, bool) {
        static_cast<Embree*>(self)->bytes_ += bytes;
        return true;
    }

    RTCDevice device_;
    RTCScene scene_ = nullptr;
    std::vector<Float3> vertices_;
    Triangles triangles_;
    ssize_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<ClosestRival> embree_rival() { return std::make_unique<Embree>(); }

}  // namespace hausbench
