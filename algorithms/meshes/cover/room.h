// Room for covering, a few hundred kB. Where small shapes are measured one after the other, making it anew would take longer than the search:
// each thread keeps what is given back.
#pragma once

#include "algorithms/meshes/cover/offset_cover.h"

#include <memory>

namespace hausbench {

class CoverRoom {
public:
    struct Covers {
        OffsetCover<float> rough;
        OffsetCover<double> exact;
    };

    CoverRoom();
    ~CoverRoom();
    CoverRoom(CoverRoom&&) = default;

    Covers& operator*() const { return *covers_; }

private:
    std::unique_ptr<Covers> covers_;
};

}  // namespace hausbench
