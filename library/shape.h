// Shapes behind the handles of the C interface.
#pragma once

#include "algorithms/prepared.h"
#include "datasets/load.h"
#include "library/hausbench.h"

#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace hausbench::library {

// Where a shape comes from.
struct Origin {
    std::string name = "arrays";  // the file it was read from
    LoadReport report = {};
    double unit = 0;  // in metres, as the caller sees it; 0: not stated
};

// A mesh or point set as the caller gave it, and the structures built over it. Thread-safe.
class Model {
public:
    // `given` has the rows as given.
    Model(Shape given, Origin origin);

    // The shape that is measured: without the vertices that no face uses. Its triangles have the numbers of the rows.
    const Shape& shape() const { return measured_; }
    ShapeKind kind() const { return kind_of(shape()); }

    // All vertices, also those that no face uses, and the faces that refer to them.
    const Points& given_points() const { return given_ ? given_->vertices : points_of(shape()); }
    const Triangles* given_faces() const;

    const Origin& origin() const { return origin_; }
    const std::string& name() const { return origin_.name; }

    double largest() const { return largest_; }  // the largest |coordinate| of shape()

    // Returns the shape scaled by 2^exponent, with the structures over it. Keeps the copies for the last few exponents,
    // so that partners of similar size share one.
    std::shared_ptr<PreparedShape> prepared(int exponent);

    // Lock it while a session is constructed over prepared(). A cancel function may construct another one meanwhile.
    std::recursive_mutex& building() { return building_; }

private:
    std::optional<TriangleMesh> given_;  // only if some vertices are not used
    SharedShape measured_;
    Origin origin_;
    double largest_;
    std::recursive_mutex building_;
    std::mutex keeping_;
    std::list<std::shared_ptr<PreparedShape>> prepared_;  // the last used first
};

// Returns the model behind a handle. Throws ArgumentError if the handle is null.
std::shared_ptr<Model> model_of(const hausbench_shape* handle, const char* name, int argument);

}  // namespace hausbench::library

struct hausbench_shape {
    std::shared_ptr<hausbench::library::Model> model;
};
